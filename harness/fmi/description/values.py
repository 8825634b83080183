"""The numbers that a variable states: start values, limits, nominal values, intervals of clocks.

What cannot be meant is None, and the judge is told.
"""

from __future__ import annotations

import math

from harness.fmi.description.entries import Entry, Judge
from harness.fmi.description.faults import Harm, quoted
from harness.fmi.description.model_description import REAL_TYPES
from harness.fmi.description.numbers import real, whole
from harness.fmi.wording import shorten


def start_value(
    one: Entry, size: int, causality: str, initial: str | None, judge: Judge
) -> str | None:
    """The start values as the document writes them, one or `size` of them."""
    text = one.value.get("start")
    if judge.major == 3 and one.type in ("String", "Binary"):
        text = next(iter(start_texts(one, judge.major)), None)
    if judge.major > 1:
        needed = initial in ("exact", "approx") or causality == "input"
        if text is None and needed and one.type != "Clock":
            judge.tell(one, "that has no start value", Harm.AMBIGUOUS, "start needed")
        if text and (initial == "calculated" or causality == "independent"):
            what = 'initial="calculated"' if initial == "calculated" else f"causality={causality}"
            judge.tell(one, f"with {what}, but provides a start value", key="start forbidden")
    if text is None or one.type in ("String", "Binary", "Clock"):
        return text
    wrong = _start_fault(one, text.split(), size, judge)
    if wrong:
        judge.tell(one, wrong, Harm.AMBIGUOUS)
    return None if wrong else text


def start_texts(one: Entry, major: int) -> tuple[str, ...]:
    """The start values of a string or binary of FMI 3."""
    found = one.element.iterchildren("Start") if major == 3 else ()
    return tuple(str(start.get("value", "")) for start in found)


def _start_fault(one: Entry, items: list[str], size: int, judge: Judge) -> str:
    if len(items) not in (1, size):
        return f"of {size} element(s) with {len(items)} start value(s)"
    for text in items:
        if one.type == "Boolean":
            legal = text in ("true", "false", "1", "0")
        else:
            value = real(text) if one.type in REAL_TYPES else whole(text)
            legal = value is not None
            if value is not None and not math.isfinite(value):
                judge.tell(one, f"that starts at {text}")
        if not legal:
            return f"of type {one.type} with the start value {quoted(text)}"
    return ""


def limits(one: Entry, judge: Judge) -> tuple[float | None, float | None]:
    """The least and the largest value that the FMU is made for."""
    low, high = real(one.get("min")), real(one.get("max"))
    if low is not None and high is not None and low > high:
        judge.tell(one, f"with min {low:g} above max {high:g}", Harm.AMBIGUOUS)
    return low, high


def nominal_value(one: Entry, judge: Judge) -> float | None:
    """A positive number, by which others are scaled."""
    nominal = real(one.get("nominal"))
    if nominal is None or (nominal > 0.0 and math.isfinite(nominal)):
        return nominal
    judge.tell(one, f"with the nominal {nominal:g}, which is disregarded")
    return None


def duration(one: Entry, what: str, judge: Judge) -> tuple[int, int] | float | None:
    """The "interval" (above 0) or the "shift" (from 0) of a clock: a number of seconds, or a
    counter and the resolution by which it is divided."""
    decimal, counter = one.get(f"{what}Decimal"), whole(one.get(f"{what}Counter"))
    resolution = whole(one.get("resolution"))
    if decimal is not None:
        made: tuple[int, int] | float | None = real(decimal)
        value = real(decimal)
    elif counter is None or resolution is None:
        return None
    else:
        made, value = (counter, resolution), counter / resolution if resolution > 0 else None
    if (
        value is not None
        and math.isfinite(value)
        and (value > 0 or (value == 0 and what == "shift"))
    ):
        return made
    shown = shorten(decimal) if decimal is not None else f"{counter}/{resolution}"
    judge.tell(one, f"with {what} {shown}, at which no clock ticks", Harm.AMBIGUOUS)
    return None
