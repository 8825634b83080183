"""The variables of modelDescription.xml, read and judged in one pass.

References are resolved to names. What cannot be meant is left out of the variable and told as a
`Fault`; nothing is allocated here, whatever sizes a description claims.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import prod
from typing import Any

from harness.fmi.description.document import Document
from harness.fmi.description.entries import TYPES, Entry, bases, read_entries, spaced
from harness.fmi.description.faults import Fault, Harm, quoted
from harness.fmi.description.model_description import (
    MAX_ELEMENTS,
    REAL_TYPES,
    Details,
    DisplayUnit,
    Variable,
)
from harness.fmi.description.numbers import boolean, integer
from harness.fmi.description.rules import rule
from harness.fmi.wording import has_control_characters, shorten

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


class VariableReader:
    """Reads all variables of a document.

    `numbered` are those by position (FMI 2) or value reference (FMI 3), by which other parts of
    the document refer to variables.
    """

    def __init__(
        self,
        document: Document,
        types: Mapping[str, Mapping[str, Any]],
        units: Mapping[str, Mapping[str, DisplayUnit]],
    ) -> None:
        self._document, self._major, self._units = document, document.major, units
        entries = read_entries(document, types)
        self.entries = tuple(entries.values())
        by_reference: dict[int | None, Entry] = {}
        for one in self.entries:
            other = by_reference.setdefault(one.reference, one)
            if self._major == 3 and other is not one:
                what = f"and {quoted(other.name)} with the same value reference {one.reference}"
                one.tell(what, Harm.AMBIGUOUS, "unique reference")
        self.numbered = entries if self._major == 2 else by_reference
        self._bases = bases(self.entries) if self._major < 3 else {}
        self._known: dict[tuple[Any, ...], Details] = {}

    def variables(self) -> dict[str, Variable]:
        """All variables by name, the aliases of FMI 3 last."""
        made = [(one, self._variable(one)) for one in self.entries]
        if self._major == 3:
            made += [(one, alias) for one, v in made for alias in self._aliases(one, v)]
        found = {variable.name: variable for _, variable in made}
        if len(found) < len(made):
            self._judge_names(made, found)
        self._judge_sizes(found)
        if self._major == 3 and sum(v.causality == "independent" for v in found.values()) != 1:
            text, cited = "has not one independent variable", rule("independent", 3)
            self._document.faults.append(Fault(Harm.NONE, text, rule=cited))
        if self._major == 2:
            self._judge_inputs(found)
        return found

    def _judge_names(
        self, made: Sequence[tuple[Entry, Variable]], found: dict[str, Variable]
    ) -> None:
        """A name of several variables is ambiguous; local ones to which the description does not
        refer are left out of `found`, so that whoever means one is told that there is none."""
        kinds: dict[str, set[str]] = {}
        again: list[tuple[Entry, str]] = []
        for one, v in made:
            again += [(one, v.name)] if v.name in kinds else []
            kinds.setdefault(v.name, set()).add(v.causality)
        referred = self._referred(v for _, v in made)
        for one, name in again:
            text, harm = f'has the variable name "{shorten(name)}" twice: ', Harm.AMBIGUOUS
            if kinds[name] == {"local"} and name not in referred:
                found.pop(name, None)
                text, harm = f"{text}local variables that are left out, since ", Harm.NONE
            self._document.tell(one.element, f"{text}it is not unique", harm, "unique name")

    def _referred(self, variables: Iterable[Variable]) -> set[str]:
        """The names to which other variables or the model structure refer."""
        keys = ("index", "valueReference", "dependencies")
        structure = self._document.root.iterfind("ModelStructure//*")
        texts = [element.get(key, "") for element in structure for key in keys]
        numbers = {integer(number) for text in texts for number in text.split()}
        found = {self.numbered[number].name for number in numbers & self.numbered.keys()}
        for v in variables:
            names = (v.derivative_of, v.details.alias_of, v.details.previous, *v.details.clocks)
            found |= {name for name in (*names, *map(str, v.dimensions)) if name is not None}
        return found

    def _variable(self, one: Entry) -> Variable:
        causality, variability = self._kind(one)
        initial = self._initial(one, causality, variability)
        dimensions = tuple(self._dimensions(one)) if self._major == 3 else ()
        shape = tuple(size for size, _ in dimensions)
        size = prod(shape)
        real = one.type in REAL_TYPES
        unit = one.get("unit") if real else None
        low, high = one.limits()
        return Variable(
            name=one.name,
            value_reference=one.reference,
            type=one.type,
            causality=causality,
            variability=variability,
            initial=initial,
            start=one.start(size, causality, initial),
            unit=unit,
            description=one.own.get("description", ""),
            minimum=low,
            maximum=high,
            nominal=one.nominal() if real else None,
            size=size,
            derivative_of=self._named(one, "derivative") if real else None,
            shape=shape,
            dimensions=tuple(given for _, given in dimensions),
            details=self._details(one, unit),
        )

    def _kind(self, one: Entry) -> tuple[str, str]:
        """Causality and variability, with the defaults of the version."""
        causality, variability = one.own.get("causality", "local"), one.own.get("variability")
        stated = variability == "continuous" or (variability is None and self._major == 2)
        if self._major == 1:
            causality = "local" if causality == "internal" else causality
            if variability == "parameter":
                return "parameter", "fixed"
        if variability is None and self._major == 3:
            default = "continuous" if one.type in REAL_TYPES else "discrete"
            variability = "fixed" if causality.lower().endswith("parameter") else default
        variability = variability or "continuous"
        if variability == "continuous" and one.type not in REAL_TYPES:
            if stated:
                what = f'of type {one.type}, which must have variability != "continuous"'
                one.tell(what, key="continuous")
            variability = "discrete"
        return causality, variability

    def _initial(self, one: Entry, causality: str, variability: str) -> str | None:
        stated = one.own.get("initial")
        if self._major == 1:
            return stated
        allowed = _INITIAL.get(variability, {}).get(causality)
        initial = allowed[0] if allowed and stated is None else stated
        if allowed is None or initial not in allowed:
            harm = Harm.AMBIGUOUS if causality == "input" and allowed is None else Harm.NONE
            what = f'with causality="{shorten(causality)}" and variability="{shorten(variability)}"'
            what += f' and initial="{initial}"' * (allowed is not None) + ", which is not allowed"
            one.tell(what, harm, "combination")
        return initial

    def _dimensions(self, one: Entry) -> Iterator[tuple[int, int | str]]:
        """The size of each dimension, and what gives it: a number or a parameter's name."""
        for dimension in one.element.iterchildren("Dimension"):
            size = integer(dimension.get("start"))
            given: int | str | None = size
            wrong = "with a dimension of no size"
            reference = dimension.get("valueReference")
            if reference is not None:
                size, given, wrong = self._dimension(reference)
            if size is None or given is None or size < 0:
                one.tell(wrong, Harm.FORBIDDEN)
            else:
                yield size, given

    def _dimension(self, reference: str) -> tuple[int | None, str, str]:
        """The size that a structural parameter states, its name, and what is wrong otherwise."""
        source = self.numbered.get(integer(reference))
        if source is None:
            wrong = f"with a dimension given by {shorten(reference)}, which no variable has"
            return None, "", wrong
        wrong = f"with a dimension given by {quoted(source.name)}"
        if (source.type, source.own.get("causality")) != ("UInt64", "structuralParameter"):
            wrong += ", which is no structural parameter of type UInt64"
            return None, "", wrong
        return integer(source.value.get("start")), source.name, f"{wrong} without a start"

    def _named(self, one: Entry, attribute: str) -> str | None:
        """The variable to which an attribute refers, None where it refers to none."""
        text = one.value.get(attribute)
        return None if text is None else next(self._references(one, attribute, text), None)

    def _references(self, one: Entry, attribute: str, text: str) -> Iterator[str]:
        wanted = {"derivative": REAL_TYPES, "clocks": {"Clock"}}.get(attribute, TYPES)
        for item in text.split():
            target = self.numbered.get(integer(item))
            if target is not None and target.type in wanted:
                yield target.name
                continue
            if target is not None:
                wrong = f"{attribute}={item}, but {quoted(target.name)} is of type {target.type}"
            elif self._major == 2:
                wrong = f"the {attribute} of variable {shorten(item)}, of {len(self.numbered)}"
            else:
                wrong = f"{attribute}={shorten(item)}, which no variable has"
            one.tell(f"with {wrong}", Harm.AMBIGUOUS)

    def _details(self, one: Entry, unit: str | None) -> Details:
        get, own, value = one.get, one.own, one.value
        base = self._bases.get(one.base, one.name)
        starts = one.start_texts()
        self._judge_unit(one, unit, get("displayUnit"))
        given = dict(
            alias_of=None if base == one.name else base,
            negated=self._major == 1 and own.get("alias") == "negatedAlias",
            relative=boolean(get("relativeQuantity")),
            display_unit=get("displayUnit"),
            declared_type=value.get("declaredType"),
            starts=starts,
            items=one.declared.get("items", ()),
            has_start=bool(starts) or "start" in value,
            multiple_sets=boolean(own.get("canHandleMultipleSetPerTimeInstant", "true")),
            reinit=boolean(value.get("reinit")),
            **(self._of_clocked(one) if self._major == 3 else {}),
            **(_of_clock(one) if one.type == "Clock" else {}),
        )
        known = self._known.get(key := tuple(given.values()))
        if known is None:
            known = self._known[key] = Details(**given)
        return known

    def _of_clocked(self, one: Entry) -> dict[str, Any]:
        return {
            "clocks": tuple(self._references(one, "clocks", one.own.get("clocks", ""))),
            "previous": self._named(one, "previous"),
            "intermediate_update": boolean(one.own.get("intermediateUpdate")),
        }

    def _judge_unit(self, one: Entry, unit: str | None, display_unit: str | None) -> None:
        if self._major == 1:
            return
        if unit is not None and unit not in self._units:
            one.tell(f"with the unit {quoted(unit)}, which is not defined", key="unit")
        elif display_unit is not None and display_unit not in self._units.get(unit or "", {}):
            what = f"with the display unit {quoted(display_unit)}, which is not defined"
            one.tell(what, key="display unit")

    def _aliases(self, one: Entry, variable: Variable) -> Iterator[Variable]:
        """The other names of a variable of FMI 3."""
        for alias in one.element.iterchildren("Alias"):
            name = spaced(alias.get("name", ""))
            if has_control_characters(name):
                one.tell(f"and {quoted(name)} with control characters", Harm.FORBIDDEN)
            shown = alias.get("displayUnit")
            if shown is not None:
                self._judge_unit(one, variable.unit, shown)
            details = replace(variable.details, alias_of=variable.name, display_unit=shown)
            text = alias.get("description") or variable.description
            yield replace(variable, name=name, description=text, details=details)

    def _judge_sizes(self, variables: Mapping[str, Variable]) -> None:
        total = sum(v.size for v in variables.values() if v.shape)
        if total > MAX_ELEMENTS:
            largest = max(variables.values(), key=lambda v: v.size)
            text = f"says that {quoted(largest.name)} has {largest.size} elements, and all arrays "
            text += f"{total}; at most {MAX_ELEMENTS} can be held"
            self._document.faults.append(Fault(Harm.FORBIDDEN, text))

    def _judge_inputs(self, variables: Mapping[str, Variable]) -> None:
        """FMI 2: one value reference of one type is one value, so it can have one source only."""
        first: dict[tuple[str, int], Entry] = {}
        for one in self.entries:
            if one.name in variables and variables[one.name].causality == "input":
                other = first.setdefault(one.base, one)
                if other.name != one.name:
                    text = f"has the inputs {quoted(other.name)} and {quoted(one.name)} with the "
                    text += f"same value reference {one.reference}, so that one would overwrite "
                    self._document.tell(one.element, text + "the other", Harm.AMBIGUOUS)


def _of_clock(one: Entry) -> dict[str, Any]:
    return {
        "interval_variability": one.get("intervalVariability"),
        "interval": one.duration("interval"),
        "shift": one.duration("shift") or 0.0,
        "can_be_deactivated": boolean(one.get("canBeDeactivated")),
        "priority": integer(one.get("priority")),
    }
