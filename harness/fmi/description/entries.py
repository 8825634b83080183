"""The variables of modelDescription.xml as the document has them, and who tells their faults."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from harness.fmi.description.faults import Fault, Harm, quoted
from harness.fmi.description.model_description import INTEGER_TYPES, REAL_TYPES
from harness.fmi.description.numbers import whole
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
        name, reference = spaced(own.get("name", "")), whole(own.get("valueReference"))
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
