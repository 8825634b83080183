"""Parameter sets and mappings to named values, read from where a binding says they are."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from warnings import warn

from harness.errors import ExperimentError
from harness.ssp import binding
from harness.ssp import document as ssd
from harness.ssp.binding import E
from harness.ssp.change import Change, Items, transformed
from harness.ssp.common import REAL_KINDS, Transformation
from harness.ssp.lexical import read_boolean, read_double, read_integer
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
        made = self.changed(Change().scaled(*exact_conversion(self.unit, port.unit)))
        unit = port.unit or (None if self.transformation else self.unit)
        if self.transformation is not None:
            source, target = self.items or port.items, port.items or self.items
            made = made.changed(transformed(Change(), self.transformation, source, target))
        return replace(made, unit=unit, items=self.items or port.items, transformation=None)

    def _number(self, one: Scalar) -> float:
        if not isinstance(one, str):
            return float(one)
        if self.items is None or one not in self.items:
            raise ExperimentError(f"{one!r} is no number and no item of a known enumeration")
        return float(self.items[one])


def bound_values(
    given: ssd.ParameterBinding, scope: Scope, component: str | None, place: str
) -> Iterator[tuple[str, Value]]:
    """Names and values that a binding gives, after prefix and mapping; `component` is the URI of
    the FMU to which it is bound, if it is one."""
    if given.type != ssd.PARAMETER_SET_TYPE:
        raise ExperimentError(
            f"{place}: parameters of type {given.type!r} cannot be read; "
            f"{ssd.PARAMETER_SET_TYPE} can"
        )
    content = given.inline
    if given.source is not None:
        content = _document(ParameterSet, given, scope, component, place)
    if content is None:
        raise ExperimentError(f"{place} has neither a source nor values")
    known = Definitions(content)
    named = {
        f"{given.prefix}{one.name}": _value(one, known, f"{place}: {one.name}")
        for one in content.parameters
    }
    if given.mapping is None:
        yield from named.items()
        return
    mapping = _mapping(given.mapping, scope, component, place)
    for entry in mapping.entries:
        if entry.source not in named:
            warn(f"{place}: mapped parameter {entry.source!r} is not in the set", stacklevel=2)
            continue
        value = named[entry.source]
        if entry.suppress_unit_conversion:
            value = replace(value, unit=None)
        yield entry.target, replace(value, transformation=entry.transformation)


def _mapping(
    given: ssd.MappingReference, scope: Scope, source: str | None, place: str
) -> ParameterMapping:
    if given.type != ssd.MAPPING_TYPE:
        raise ExperimentError(
            f"{place}: mappings of type {given.type!r} cannot be read; {ssd.MAPPING_TYPE} can"
        )
    found = given.inline
    if given.source is not None:
        found = _document(ParameterMapping, given, scope, source, place)
    if found is None:
        raise ExperimentError(f"{place}: its mapping has neither a source nor a content")
    return found


def _document(
    kind: type[E],
    given: ssd.ParameterBinding | ssd.MappingReference,
    scope: Scope,
    component: str | None,
    place: str,
) -> E:
    """A document by its URI, relative to the description or to the FMU."""
    assert given.source is not None
    what = place.rpartition(": ")[2]
    if given.source_base == "SSD":
        return scope.document(kind, given.source, what)
    if component is None:
        raise ExperimentError(f"{place}: {given.source!r} is relative to a component without FMU")
    archive = scope.resolve(component, what)
    return binding.read(kind, _member(archive, given.source, place), f"{place}: {given.source}")


def _member(archive: Path, name: str, place: str) -> bytes:
    try:
        with zipfile.ZipFile(archive) as opened:
            return opened.read(name)
    except (OSError, KeyError, zipfile.BadZipFile, RuntimeError) as fault:
        raise ExperimentError(f"{place}: {archive.name} has no readable {name!r}") from fault


def _value(parameter: Parameter, known: Definitions, place: str) -> Value:
    given = parameter.value
    texts = [one.value for one in given.items]
    if given.value is not None:
        texts = [given.value] if given.kind in ("String", "Enumeration") else given.value.split()
    if given.kind == "Binary":
        raise ExperimentError(f"{place}: binary parameters cannot be set")
    try:
        content = tuple(_scalar(given.kind, one) for one in texts)
    except ValueError as fault:
        raise ExperimentError(f"{place}: the {given.kind} {given.value!r} is {fault}") from fault
    if not content:
        raise ExperimentError(f"{place} has no value")
    unit, items = known.unit(given.unit), known.items(given.name)
    return Value(content, unit, items, array=bool(parameter.dimensions))


def _scalar(kind: str, text: str) -> Scalar:
    if kind in REAL_KINDS:
        return read_double(text)
    if kind == "Boolean":
        return read_boolean(text)
    if kind in ("String", "Enumeration"):
        return text
    return read_integer(text)
