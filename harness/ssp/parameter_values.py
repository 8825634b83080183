"""Parameter sets and mappings to named values, read from where a binding says they are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from warnings import warn

from harness.errors import ExperimentError, UnitError, nearest
from harness.ssp import document as ssd
from harness.ssp.change import Change, Items, transformed
from harness.ssp.common import KINDS, Transformation
from harness.ssp.lexical import FORMS
from harness.ssp.parameters import Parameter, ParameterMapping, ParameterSet
from harness.ssp.ports import Port
from harness.ssp.tree import Definitions, Scope
from harness.system.units import Unit, exact_conversion

Scalar = float | int | bool | str


@dataclass(frozen=True)
class Value:
    """A parameter's value: one scalar, or those of an array. `unit` is that of its numbers, `items`
    are those of its enumeration, `transformation` is yet to be applied; `array` tells an array of
    one from a scalar."""

    content: tuple[Scalar, ...]
    unit: Unit | None = None
    items: Items | None = None
    transformation: Transformation | None = None
    array: bool = False

    def changed(self, change: Change) -> Value:
        """With another content of its numbers; items of an enumeration become numbers."""
        if change == Change():
            return self
        return replace(self, content=tuple(change.of(self._number(one)) for one in self.content))

    def settled(self, port: Port) -> Value:
        """As the connector or variable `port` takes it: converted to its unit, then transformed.

        Raises `ExperimentError` or `UnitError`.
        """
        made = self.changed(Change().scaled(*_conversion(self.unit, port.unit)))
        unit = port.unit or (None if self.transformation else self.unit)
        if self.transformation is not None:
            source, target = self.items or port.items, port.items or self.items
            made = made.changed(transformed(Change(), self.transformation, source, target))
        return replace(made, unit=unit, items=self.items or port.items, transformation=None)

    def _number(self, one: Scalar) -> float:
        if not isinstance(one, str):
            return float(one)
        if self.items is None or one not in self.items:
            hint = nearest(one, self.items or ())
            raise ExperimentError(
                f"{one!r} is no number and no item of a known enumeration; {hint}"
            )
        return float(self.items[one])


def _conversion(given: Unit | None, wanted: Unit | None) -> tuple[Fraction, Fraction]:
    """Factor and offset; a unit that is defined wrongly or not at all and has the name of the
    other one, perhaps in brackets, is that one, with a warning."""
    try:
        return exact_conversion(given, wanted)
    except UnitError as fault:
        if given is None or wanted is None or given.name.strip("[]") != wanted.name.strip("[]"):
            raise
        warn(f"values in {given.name!r} are taken as they are: {fault}", stacklevel=2)
        return Fraction(1), Fraction(0)


def bound_values(
    given: ssd.ParameterBinding, scope: Scope, fmu: str | None, place: str
) -> Iterator[tuple[str, Value]]:
    """Names and values that a binding gives, after prefix and mapping; `fmu` is the URI of the FMU
    to which it is bound, if it is one. Raises `ExperimentError`."""
    content = scope.content(ParameterSet, given, ssd.PARAMETER_SET_TYPE, fmu)
    known = Definitions(content)
    named = {f"{given.prefix}{one.name}": _value(one, known) for one in content.parameters}
    if given.mapping is None:
        yield from named.items()
        return
    mapping = scope.content(ParameterMapping, given.mapping, ssd.MAPPING_TYPE, fmu)
    for entry in mapping.entries:
        if entry.source not in named:
            warn(f"{place}: mapped parameter {entry.source!r} is not in the set", stacklevel=2)
            continue
        value = named[entry.source]
        if entry.suppress_unit_conversion:
            value = replace(value, unit=None)
        yield entry.target, replace(value, transformation=entry.transformation)


def _value(parameter: Parameter, known: Definitions) -> Value:
    given, form = parameter.value, KINDS[parameter.value.kind]
    texts = [one.value for one in given.items]
    if given.value is not None:
        texts = [given.value] if form is str else given.value.split()
    if given.kind == "Binary":
        raise ExperimentError(f"{parameter.name}: binary parameters cannot be set; leave it out")
    try:
        content = tuple(map(FORMS[form].read, texts))
    except ValueError as fault:
        what = f"the {given.kind} {given.value!r}"
        raise ExperimentError(f"{parameter.name}: {what} is {fault}") from fault
    if not content:
        raise ExperimentError(f"{parameter.name} has no value; give it one")
    unit, items = known.unit(given.unit), known.items(given.name)
    return Value(content, unit, items, array=bool(parameter.dimensions))
