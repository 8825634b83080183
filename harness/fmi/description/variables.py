"""The variables of modelDescription.xml, read and judged in one pass.

References are resolved to names. What cannot be meant is left out of the variable and told as a
`Fault`; nothing is allocated here, whatever sizes a description claims.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import prod
from typing import Any

from harness.fmi.description.faults import Fault, Harm, quoted
from harness.fmi.description.model_description import (
    INTEGER_TYPES,
    REAL_TYPES,
    Details,
    DisplayUnit,
    Variable,
)
from harness.fmi.description.numbers import real as number
from harness.fmi.description.numbers import true, whole
from harness.fmi.description.rules import rule
from harness.fmi.wording import has_control_characters, shorten

MAX_ELEMENTS = 2**24
"""Elements of all variables of an FMU together."""

_VALUES = ("Real", "Integer", "Boolean", "String", "Enumeration")
_TYPES = REAL_TYPES | INTEGER_TYPES | {"Boolean", "String", "Binary", "Clock"}
_BLANKS = str.maketrans("\t\n\r", "   ")
_EXACT, _CALCULATED = ("exact",), ("calculated", "approx")
_ANY = ("calculated", "exact", "approx")
_PARAMETER = {
    "structuralParameter": _EXACT, "parameter": _EXACT, "calculatedParameter": _CALCULATED,
    "local": _CALCULATED,
}  # fmt: skip
_FREE = {"input": _EXACT, "output": _ANY, "local": _ANY}
_INITIAL: Mapping[str, Mapping[str, tuple[str | None, ...]]] = {
    "constant": {"output": _EXACT, "local": _EXACT},
    "fixed": _PARAMETER,
    "tunable": _PARAMETER,
    "discrete": _FREE,
    "continuous": {**_FREE, "independent": (None,)},
}
"""What `initial` may be, the default first, by variability and causality."""


@dataclass(frozen=True)
class Entry:
    """A variable as the document has it: the attributes of its type are its own in FMI 3 and those
    of a child before; `declared` are those of its declared type."""

    element: Any
    name: str
    reference: int
    type: str
    value: Mapping[str, Any]
    declared: Mapping[str, Any]

    @property
    def label(self) -> str:
        """The name in quotes."""
        return quoted(self.name)

    def get(self, key: str) -> Any:
        """An attribute of the variable's type, that of its declared type where it has none."""
        found = self.value.get(key)
        return self.declared.get(key) if found is None else found


class VariableReader:
    """Reads all variables; `faults` grows while it does.

    `numbered` are the names by position (FMI 2) or value reference (FMI 3), by which other parts
    of the document refer to variables.
    """

    def __init__(
        self,
        root: Any,
        major: int,
        types: Mapping[str, Mapping[str, Any]],
        units: Mapping[str, Mapping[str, DisplayUnit]],
        faults: list[Fault],
    ) -> None:
        self._major, self._types, self._units, self._faults = major, types, units, faults
        elements = enumerate(root.find("ModelVariables").iterchildren("*"), start=1)
        found = {position: self._entry(element) for position, element in elements}
        self.entries = {position: one for position, one in found.items() if one is not None}
        self._by_reference: dict[int, Entry] = {}
        for one in self.entries.values():
            other = self._by_reference.setdefault(one.reference, one)
            if major == 3 and other is not one:
                self._tell(
                    one, f"has {other.label} and {one.label} with the same value reference "
                    f"{one.reference}", Harm.AMBIGUOUS, "unique reference",
                )  # fmt: skip
        by_number = self.entries if major == 2 else self._by_reference
        self.numbered = {number: one.name for number, one in by_number.items()}
        self._bases = _bases(self.entries.values()) if major < 3 else {}

    def variables(self) -> dict[str, Variable]:
        """All variables by name, the aliases of FMI 3 last."""
        made = [(one, self._variable(one)) for one in self.entries.values()]
        made += [pair for one, v in made for pair in self._aliases(one, v)]
        found: dict[str, Variable] = {}
        for one, variable in made:
            if variable.name in found:
                text = f'has the variable name "{shorten(variable.name)}" twice: it is not unique'
                self._tell(one, text, Harm.AMBIGUOUS, "unique name")
            found[variable.name] = variable
        self._judge_sizes(found)
        if self._major == 3 and sum(v.causality == "independent" for v in found.values()) != 1:
            cited = rule("independent", 3)
            self._faults.append(Fault(Harm.NONE, "has not one independent variable", rule=cited))
        if self._major == 2:
            self._judge_inputs(found)
        return found

    def _tell(self, one: Entry, text: str, harm: Harm = Harm.NONE, key: str = "") -> None:
        cited = rule(key, self._major) if key else ""
        self._faults.append(Fault(harm, text, one.element.sourceline or 0, cited))

    def _entry(self, element: Any) -> Entry | None:
        """None where name, value reference or type cannot be read."""
        attributes = dict(element.attrib)
        name = str(attributes.get("name", "")).translate(_BLANKS)
        reference = whole(attributes.get("valueReference"))
        kind, value = element.tag, attributes
        if self._major < 3:
            children = (child for child in element.iterchildren("*") if child.tag in _VALUES)
            child = next(children, None)
            kind, value = ("", {}) if child is None else (child.tag, dict(child.attrib))
        declared = value.get("declaredType")
        made = Entry(element, name, reference or 0, kind, value, self._types.get(str(declared), {}))
        wrong = "with control characters in its name" * has_control_characters(name)
        if kind not in _TYPES:
            wrong = f"of the unknown type {shorten(str(kind))!r}"
        elif reference is None or not 0 <= reference < 2**32:
            wrong = "without a value reference that can be used"
        if wrong and "name" in attributes:
            self._tell(made, f"has {made.label} {wrong}", Harm.FORBIDDEN)
        if declared is not None and declared not in self._types:
            text = f"has {made.label} with declaredType={quoted(declared)}, which has not been "
            self._tell(made, text + "defined", Harm.AMBIGUOUS)
        return None if wrong or "name" not in attributes else made

    def _variable(self, one: Entry) -> Variable:
        causality, variability = self._kind(one)
        initial = self._initial(one, causality, variability)
        dimensions = tuple(self._dimensions(one))
        shape = tuple(size for size, _ in dimensions)
        real = one.type in REAL_TYPES
        unit = one.get("unit") if real else None
        starts = self._starts(one)
        return Variable(
            name=one.name,
            value_reference=one.reference,
            type=one.type,
            causality=causality,
            variability=variability,
            initial=initial,
            start=self._start(one, starts, prod(shape), causality, initial),
            unit=unit,
            description=one.element.get("description", ""),
            **self._limits(one),
            nominal=self._nominal(one) if real else None,
            size=prod(shape),
            derivative_of=self._named(one, "derivative") if real else None,
            shape=shape,
            dimensions=tuple(given for _, given in dimensions),
            details=self._details(one, unit, starts),
        )

    def _kind(self, one: Entry) -> tuple[str, str]:
        """Causality and variability, with the defaults of the version."""
        causality = one.element.get("causality", "local")
        variability = one.element.get("variability")
        told = variability == "continuous" or (variability is None and self._major == 2)
        if self._major == 1:
            causality = "local" if causality == "internal" else causality
            if variability == "parameter":
                return "parameter", "fixed"
        if self._major < 3:
            variability = variability or "continuous"
        elif variability is None:
            real = one.type in REAL_TYPES
            default = "continuous" if real else "discrete"
            variability = "fixed" if causality.lower().endswith("parameter") else default
        if variability == "continuous" and one.type not in REAL_TYPES:
            if told:
                text = f'has {one.label} of type {one.type}, which must have variability != "con'
                self._tell(one, text + 'tinuous"', Harm.NONE, "continuous")
            variability = "discrete"
        return causality, variability

    def _initial(self, one: Entry, causality: str, variability: str) -> str | None:
        stated: str | None = one.element.get("initial")
        if self._major == 1:
            return stated
        allowed = _INITIAL.get(variability, {}).get(causality)
        initial = allowed[0] if allowed and stated is None else stated
        if allowed is None or initial not in allowed:
            harm = Harm.AMBIGUOUS if causality == "input" and allowed is None else Harm.NONE
            self._tell(
                one, f'has {one.label} with causality="{shorten(causality)}" and variability='
                f'"{shorten(variability)}"' + f' and initial="{initial}"' * (allowed is not None)
                + ", which is not allowed", harm, "combination",
            )  # fmt: skip
        return initial

    def _dimensions(self, one: Entry) -> Iterator[tuple[int, int | str]]:
        """The size of each dimension, and what gives it: a number or a parameter's name."""
        for dimension in one.element.iterchildren("Dimension"):
            reference = dimension.get("valueReference")
            if reference is None:
                size, given = whole(dimension.get("start")), whole(dimension.get("start"))
                if size is None or given is None or size < 0:
                    self._tell(one, f"has {one.label} with a dimension of no size", Harm.FORBIDDEN)
                    continue
                yield size, given
                continue
            source = self._by_reference.get(whole(reference) or 0)
            text = f"has {one.label} with a dimension given by "
            if source is None or str(source.reference) != reference.strip():
                text += f"{shorten(reference)}, which no variable has"
                self._tell(one, text, Harm.FORBIDDEN)
                continue
            if (source.type, source.element.get("causality")) != ("UInt64", "structuralParameter"):
                text += f"{source.label}, which is no structural parameter of type UInt64"
                self._tell(one, text, Harm.FORBIDDEN)
                continue
            size = whole(source.value.get("start"))
            if size is None or size < 0:
                self._tell(one, f"{text}{source.label} without a start", Harm.FORBIDDEN)
                continue
            yield size, source.name

    def _starts(self, one: Entry) -> tuple[str, ...]:
        """The start values of strings and binaries of FMI 3."""
        found = one.element.iterchildren("Start") if self._major == 3 else ()
        return tuple(str(start.get("value", "")) for start in found)

    def _start(
        self, one: Entry, starts: tuple[str, ...], size: int, causality: str, initial: str | None
    ) -> str | None:
        text = one.value.get("start")
        if self._major == 3 and one.type in ("String", "Binary"):
            text = starts[0] if starts else None
        if self._major > 1:
            needs = initial in ("exact", "approx") or causality == "input"
            if text is None and needs and one.type != "Clock":
                told = f"has {one.label}, which has no start value"
                self._tell(one, told, Harm.AMBIGUOUS, "start needed")
            if text and (initial == "calculated" or causality == "independent"):
                what = causality if causality == "independent" else 'initial="calculated"'
                told = f"has {one.label} with {what}, but provides a start value"
                self._tell(one, told, Harm.NONE, "start forbidden")
        if text is None or one.type in ("String", "Binary", "Clock"):
            return text
        wrong = self._start_fault(one, text.split(), size)
        if wrong:
            self._tell(one, f"has {one.label} {wrong}", Harm.AMBIGUOUS)
        return None if wrong else text

    def _start_fault(self, one: Entry, items: list[str], size: int) -> str:
        """What is wrong with the start values of a number or Boolean, or ""."""
        if len(items) not in (1, size):
            return f"of {size} element(s) with {len(items)} start value(s)"
        for text in items:
            if one.type == "Boolean":
                legal = text in ("true", "false", "1", "0")
            else:
                value = number(text) if one.type in REAL_TYPES else whole(text)
                legal = value is not None
                if legal and not math.isfinite(value):  # type: ignore[arg-type]
                    self._tell(one, f"has {one.label}, which starts at {text}")
            if not legal:
                return f"of type {one.type} with the start value {quoted(text)}"
        return ""

    def _limits(self, one: Entry) -> dict[str, float | None]:
        low, high = number(one.get("min")), number(one.get("max"))
        if low is not None and high is not None and low > high:
            text = f"has {one.label} with min {low:g} above max {high:g}"
            self._tell(one, text, Harm.AMBIGUOUS)
        return {"minimum": low, "maximum": high}

    def _nominal(self, one: Entry) -> float | None:
        nominal = number(one.get("nominal"))
        if nominal is None or (nominal > 0.0 and math.isfinite(nominal)):
            return nominal
        text = f"has {one.label} with the nominal {nominal:g}, which is disregarded"
        self._tell(one, text)
        return None

    def _named(self, one: Entry, attribute: str) -> str | None:
        """The variable to which an attribute refers, None where it refers to none."""
        text = one.value.get(attribute)
        return None if text is None else next(self._references(one, attribute, text), None)

    def _references(self, one: Entry, attribute: str, text: str) -> Iterator[str]:
        wanted = {"derivative": REAL_TYPES, "clocks": {"Clock"}}.get(attribute, _TYPES)
        by_number = self.entries if self._major == 2 else self._by_reference
        for item in text.split():
            target = by_number.get(-1 if whole(item) is None else int(item))
            if target is not None and target.type in wanted:
                yield target.name
                continue
            if target is not None:
                wrong = f"{attribute}={item}, but {target.label} is of type {target.type}"
            elif self._major == 2:
                wrong = f"the {attribute} of variable {shorten(item)}, of {len(by_number)}"
            else:
                wrong = f"{attribute}={shorten(item)}, which no variable has"
            self._tell(one, f"has {one.label} with {wrong}", Harm.AMBIGUOUS)

    def _details(self, one: Entry, unit: str | None, starts: tuple[str, ...]) -> Details:
        get, element = one.get, one.element
        base = self._bases.get((_base_type(one), one.reference), one.name)
        found: dict[str, Any] = {
            "alias_of": None if base == one.name else base,
            "negated": self._major == 1 and element.get("alias") == "negatedAlias",
            "relative": true(get("relativeQuantity")),
            "display_unit": get("displayUnit"),
            "declared_type": one.value.get("declaredType"),
            "starts": starts,
            "items": one.declared.get("items", ()),
            "has_start": bool(starts) or one.value.get("start") is not None,
            "multiple_sets": true(element.get("canHandleMultipleSetPerTimeInstant", "true")),
            "reinit": true(one.value.get("reinit")),
        }
        if unit is not None or found["display_unit"] is not None:
            self._judge_unit(one, unit, found["display_unit"])
        if self._major == 3:
            clocks = element.get("clocks")
            found |= {
                "clocks": tuple(self._references(one, "clocks", clocks)) if clocks else (),
                "previous": self._named(one, "previous"),
                "intermediate_update": true(element.get("intermediateUpdate")),
            }
        if one.type == "Clock":
            found |= {
                "interval_variability": get("intervalVariability"),
                "interval": self._duration(one, "interval"),
                "shift": self._duration(one, "shift") or 0.0,
                "can_be_deactivated": true(get("canBeDeactivated")),
                "priority": whole(get("priority")),
            }
        return Details(**found)

    def _duration(self, one: Entry, what: str) -> tuple[int, int] | float | None:
        """An interval (above 0) or a shift (from 0) of a clock."""
        decimal, counter = one.get(f"{what}Decimal"), one.get(f"{what}Counter")
        resolution, value = whole(one.get("resolution")), number(decimal)
        made: tuple[int, int] | float | None = value
        if decimal is None:
            count = whole(counter)
            if count is None or resolution is None:
                return None
            made = (count, resolution)
            value = count / resolution if resolution > 0 else math.nan
        legal = value is not None and math.isfinite(value) and value >= 0.0
        if legal and (value or what == "shift"):
            return made
        shown = decimal if decimal is not None else f"{counter}/{resolution}"
        text = f"has the clock {one.label} with {what} {shorten(str(shown))}"
        self._tell(one, text, Harm.AMBIGUOUS)
        return None

    def _judge_unit(self, one: Entry, unit: str | None, display_unit: str | None) -> None:
        if self._major == 1:
            return
        if unit is not None and unit not in self._units:
            text = f"has {one.label} with the unit {quoted(unit)}, which is not defined"
            self._tell(one, text, Harm.NONE, "unit")
        elif display_unit is not None and display_unit not in self._units.get(unit or "", {}):
            text = f"has {one.label} with the display unit {quoted(display_unit)}, which is not "
            self._tell(one, text + "defined for its unit", Harm.NONE, "display unit")

    def _aliases(self, one: Entry, variable: Variable) -> Iterator[tuple[Entry, Variable]]:
        """The other names of a variable of FMI 3."""
        for alias in one.element.iterchildren("Alias") if self._major == 3 else ():
            name = str(alias.get("name", "")).translate(_BLANKS)
            if has_control_characters(name):
                told = f"has {quoted(name)} with control characters in its name"
                self._tell(one, told, Harm.FORBIDDEN)
            shown = alias.get("displayUnit")
            if shown is not None:
                self._judge_unit(one, variable.unit, shown)
            details = replace(variable.details, alias_of=variable.name, display_unit=shown)
            text = alias.get("description") or variable.description
            yield one, replace(variable, name=name, description=text, details=details)

    def _judge_sizes(self, variables: Mapping[str, Variable]) -> None:
        total = sum(v.size for v in variables.values() if v.shape)
        if total > MAX_ELEMENTS:
            largest = max(variables.values(), key=lambda v: v.size)
            text = f"says that {quoted(largest.name)} has {largest.size} elements, and all arrays "
            text += f"{total}; at most {MAX_ELEMENTS} can be held"
            self._faults.append(Fault(Harm.FORBIDDEN, text))

    def _judge_inputs(self, variables: Mapping[str, Variable]) -> None:
        """FMI 2: one value reference of one type is one value, so it can have one source only."""
        first: dict[tuple[str, int], Entry] = {}
        for one in self.entries.values():
            if variables[one.name].causality == "input":
                other = first.setdefault((_base_type(one), one.reference), one)
                if other is not one and other.name != one.name:
                    text = f"has the inputs {other.label} and {one.label} with the same value "
                    text += f"reference {one.reference}, so that one would overwrite the other"
                    self._tell(one, text, Harm.AMBIGUOUS)


def _base_type(one: Entry) -> str:
    return "Integer" if one.type == "Enumeration" else one.type


def _bases(entries: Any) -> dict[tuple[str, int], str]:
    """FMI 1 and 2: of the variables that share a value reference, the one that the others are
    other names of: one that can be set, or the first."""
    first: dict[tuple[str, int], str] = {}
    settable: dict[tuple[str, int], str] = {}
    for one in entries:
        key = (_base_type(one), one.reference)
        if one.element.get("alias", "noAlias") == "noAlias":
            first.setdefault(key, one.name)
            if one.element.get("causality") in ("input", "parameter"):
                settable.setdefault(key, one.name)
    return first | settable
