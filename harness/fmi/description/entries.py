"""The variables of modelDescription.xml as the document has them, who tells their faults, and the
numbers that they state: start values, limits, nominal values, intervals of clocks.

What cannot be meant is None, and the judge is told.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from harness.fmi.description.faults import Fault, Harm, quoted
from harness.fmi.description.model_description import INTEGER_TYPES, REAL_TYPES
from harness.fmi.description.numbers import integer, real
from harness.fmi.description.rules import rule
from harness.fmi.wording import has_control_characters, shorten

TYPES = REAL_TYPES | INTEGER_TYPES | {"Boolean", "String", "Binary", "Clock"}
_VALUES = ("Real", "Integer", "Boolean", "String", "Enumeration")
_BLANKS = str.maketrans("\t\n\r", "   ")


class Entry(NamedTuple):
    """A variable: its attributes `own`, those of its type in `value` (its own in FMI 3, those of a
    child before), and those of its `declared` type."""

    element: Any
    name: str
    reference: int
    type: str
    own: Mapping[str, str]
    value: Mapping[str, str]
    declared: Mapping[str, Any]

    @property
    def base(self) -> tuple[str, int]:
        """What two names of one variable of FMI 1 or 2 have in common."""
        return "Integer" if self.type == "Enumeration" else self.type, self.reference

    def get(self, key: str) -> Any:
        """An attribute of the variable's type, that of its declared type where it has none."""
        found = self.value.get(key)
        return self.declared.get(key) if found is None else found


@dataclass(frozen=True)
class Judge:
    """Adds what is wrong with variables to `faults`."""

    major: int
    faults: list[Fault]

    def tell(self, one: Entry, what: str, harm: Harm = Harm.NONE, key: str = "") -> None:
        """The document has this variable `what`; `key` names the sentence that it breaks."""
        self.say(one, f"has {quoted(one.name)} {what}", harm, key)

    def say(self, one: Entry, text: str, harm: Harm = Harm.NONE, key: str = "") -> None:
        """The same with the phrase in full."""
        cited = rule(key, self.major) if key else ""
        self.faults.append(Fault(harm, text, one.element.sourceline or 0, cited))

    def entries(self, root: Any, types: Mapping[str, Mapping[str, Any]]) -> dict[int, Entry]:
        """All variables by position (from 1), without those that cannot be read."""
        elements = enumerate(root.find("ModelVariables").iterchildren("*"), start=1)
        found = ((position, self._entry(element, types)) for position, element in elements)
        return {position: one for position, one in found if one is not None}

    def _entry(self, element: Any, types: Mapping[str, Mapping[str, Any]]) -> Entry | None:
        own = dict(element.items())
        name, reference = spaced(own.get("name", "")), integer(own.get("valueReference"))
        kind, value = element.tag, own
        if self.major < 3:
            kind, value = "", {}
            for child in element:
                if child.tag in _VALUES:
                    kind, value = child.tag, dict(child.items())
                    break
        declared = value.get("declaredType")
        attributes = types.get(declared, {}) if declared is not None else {}
        made = Entry(element, name, reference or 0, kind, own, value, attributes)
        if "name" not in own:
            return None
        wrong = "with control characters in its name" * has_control_characters(name)
        if kind not in TYPES:
            wrong = f"of the unknown type {shorten(str(kind))!r}"
        elif reference is None or not 0 <= reference < 2**32:
            wrong = "without a value reference that can be used"
        if wrong:
            self.tell(made, wrong, Harm.FORBIDDEN)
            return None
        if declared is not None and declared not in types:
            what = f"with declaredType={quoted(declared)}, which has not been defined"
            self.tell(made, what, Harm.AMBIGUOUS)
        return made


def spaced(name: str) -> str:
    """A name as the schema's type normalizedString has it: tabs and line ends are spaces."""
    return name.translate(_BLANKS) if has_control_characters(name) else name


def bases(entries: Iterable[Entry]) -> dict[tuple[str, int], str]:
    """FMI 1 and 2: of the variables that share a value reference, the one that the others are
    other names of: one that can be set, or the first."""
    first: dict[tuple[str, int], str] = {}
    settable: dict[tuple[str, int], str] = {}
    for one in entries:
        if one.own.get("alias", "noAlias") == "noAlias":
            first.setdefault(one.base, one.name)
            if one.own.get("causality") in ("input", "parameter"):
                settable.setdefault(one.base, one.name)
    return first | settable


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
            value = real(text) if one.type in REAL_TYPES else integer(text)
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
    decimal, counter = one.get(f"{what}Decimal"), integer(one.get(f"{what}Counter"))
    resolution = integer(one.get("resolution"))
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
