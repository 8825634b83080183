"""The variables of modelDescription.xml as the document has them, and the numbers that they state:
start values, limits, nominal values, intervals of clocks.

What cannot be meant is None, and told to the document.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from harness.fmi.description.document import Document
from harness.fmi.description.faults import Harm, quoted
from harness.fmi.description.model_description import INTEGER_TYPES, REAL_TYPES
from harness.fmi.description.numbers import integer, real
from harness.fmi.wording import has_control_characters, shorten

TYPES = REAL_TYPES | INTEGER_TYPES | {"Boolean", "String", "Binary", "Clock"}
_VALUES = ("Real", "Integer", "Boolean", "String", "Enumeration")
_BLANKS = str.maketrans("\t\n\r", "   ")


class Entry(NamedTuple):
    """A variable: its attributes `own`, those of its type in `value` (its own in FMI 3, those of a
    child before), and those of its `declared` type. `base` is what two names of one variable of
    FMI 1 or 2 have in common."""

    document: Document
    element: Any
    name: str
    reference: int
    type: str
    own: Mapping[str, str]
    value: Mapping[str, str]
    declared: Mapping[str, Any]
    base: tuple[str, int]

    def get(self, key: str) -> Any:
        """An attribute of the variable's type, that of its declared type where it has none."""
        return self.value.get(key, self.declared.get(key))

    def tell(self, what: str, harm: Harm = Harm.NONE, key: str = "") -> None:
        """The document has this variable `what`; `key` names the sentence that it breaks."""
        self.document.tell(self.element, f"has {quoted(self.name)} {what}", harm, key)

    def limits(self) -> tuple[float | None, float | None]:
        """The least and the largest value that the FMU is made for."""
        low, high = real(self.get("min")), real(self.get("max"))
        if low is not None and high is not None and low > high:
            self.tell(f"with min {low:g} above max {high:g}", Harm.AMBIGUOUS)
        return low, high

    def nominal(self) -> float | None:
        """A positive number, by which others are scaled."""
        nominal = real(self.get("nominal"))
        if nominal is None or (nominal > 0.0 and math.isfinite(nominal)):
            return nominal
        self.tell(f"with the nominal {nominal:g}, which is disregarded")
        return None

    def duration(self, what: str) -> tuple[int, int] | float | None:
        """The "interval" (above 0) or the "shift" (from 0) of a clock: a number of seconds, or a
        counter and the resolution by which it is divided."""
        decimal, counter = self.get(f"{what}Decimal"), integer(self.get(f"{what}Counter"))
        resolution = integer(self.get("resolution"))
        made: tuple[int, int] | float | None = real(decimal)
        value, shown = real(decimal), shorten(str(decimal))
        if decimal is None:
            if counter is None or resolution is None:
                return None
            made, shown = (counter, resolution), f"{counter}/{resolution}"
            value = counter / resolution if resolution > 0 else None
        legal = value is not None and math.isfinite(value)
        if value is not None and legal and (value > 0 or (value == 0 and what == "shift")):
            return made
        self.tell(f"with {what} {shown}, at which no clock ticks", Harm.AMBIGUOUS)
        return None

    def start_texts(self) -> tuple[str, ...]:
        """The start values of a string or binary of FMI 3."""
        found = self.element.iterchildren("Start") if self._has_texts else ()
        return tuple(str(start.get("value", "")) for start in found)

    @property
    def _has_texts(self) -> bool:
        return self.document.major == 3 and self.type in ("String", "Binary")

    def start(self, size: int, causality: str, initial: str | None) -> str | None:
        """The start values as the document writes them, one or `size` of them."""
        text = self.value.get("start")
        if self._has_texts:
            text = next(iter(self.start_texts()), None)
        if self.document.major > 1:
            needed = initial in ("exact", "approx") or causality == "input"
            if text is None and needed and self.type != "Clock":
                self.tell("that has no start value", Harm.AMBIGUOUS, "start needed")
            calculated = initial == "calculated"
            if text and (calculated or causality == "independent"):
                what = 'initial="calculated"' if calculated else f"causality={causality}"
                self.tell(f"with {what}, but provides a start value", key="start forbidden")
        if text is None or self.type in ("String", "Binary", "Clock"):
            return text
        wrong = self._start_fault(text.split(), size)
        if wrong:
            self.tell(wrong, Harm.AMBIGUOUS)
        return None if wrong else text

    def _start_fault(self, items: list[str], size: int) -> str:
        if len(items) not in (1, size):
            return f"of {size} element(s) with {len(items)} start value(s)"
        for text in items:
            if self.type == "Boolean":
                legal = text in ("true", "false", "1", "0")
            else:
                value = real(text) if self.type in REAL_TYPES else integer(text)
                legal = value is not None
                if value is not None and not math.isfinite(value):
                    self.tell(f"that starts at {text}")
            if not legal:
                return f"of type {self.type} with the start value {quoted(text)}"
        return ""


def read_entries(
    document: Document, types: Mapping[str, Mapping[str, Any]]
) -> dict[int | None, Entry]:
    """All variables by position (from 1), without those that cannot be read."""
    elements = document.root.find("ModelVariables").iterchildren("*")
    found = {i: _entry(document, one, types) for i, one in enumerate(elements, start=1)}
    return {position: one for position, one in found.items() if one is not None}


def _entry(
    document: Document, element: Any, types: Mapping[str, Mapping[str, Any]]
) -> Entry | None:
    own = dict(element.items())
    if "name" not in own:
        return None
    kind, value = element.tag, own
    if document.major < 3:
        child = next(element.iterchildren(*_VALUES), None)
        kind, value = ("", {}) if child is None else (child.tag, dict(child.items()))
    name, reference = spaced(own["name"]), integer(own.get("valueReference"))
    declared = value.get("declaredType", "")
    base = "Integer" if kind == "Enumeration" else kind, reference or 0
    made = Entry(document, element, name, base[1], kind, own, value, types.get(declared, {}), base)
    wrong = "with control characters in its name" * has_control_characters(name)
    if kind not in TYPES:
        wrong = f"of the unknown type {shorten(str(kind))!r}"
    elif reference is None or not 0 <= reference < 2**32:
        wrong = "without a value reference that can be used"
    if wrong:
        made.tell(wrong, Harm.FORBIDDEN)
        return None
    if "declaredType" in value and declared not in types:
        what = f"with declaredType={quoted(declared)}, which has not been defined"
        made.tell(what, Harm.AMBIGUOUS)
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
