"""FMUs in the words of a system description: connectors, units and start values."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from harness.errors import ExperimentError, UsageError
from harness.fmi.description.model_description import (
    INTEGER_TYPES,
    REAL_TYPES,
    ModelDescription,
    Variable,
)
from harness.fmi.start_values import find_target, judge_start_values
from harness.ssp.common import KINDS, BaseUnit, DataType, Dimension, UnitDefinition
from harness.ssp.document import Connector, ParameterBinding
from harness.ssp.lexical import FORMS
from harness.ssp.parameters import Parameter, ParameterSet, ParameterValue, ValueItem
from harness.ssp.ports import unit_of
from harness.system.graph import Endpoint
from harness.system.units import Unit, conversion

_BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


class Units:
    """Gathers the units that a description names; units of one name must mean the same."""

    def __init__(self) -> None:
        self._known: dict[str, Unit] = {}

    def name(self, unit: Unit | None) -> str | None:
        """The name to state, None where nothing defines the unit; raises `ExperimentError`."""
        if unit is None or unit.exponents is None:
            return None
        known = self._known.setdefault(unit.name, unit)
        if known != unit:
            raise ExperimentError(f"two FMUs define the unit {unit.name!r} differently")
        return unit.name

    def definitions(self) -> tuple[UnitDefinition, ...]:
        """All units named so far."""
        return tuple(_definition(unit) for unit in self._known.values())


def _definition(unit: Unit) -> UnitDefinition:
    exponents: dict[str, Any] = dict(zip(_BASE, unit.exponents or (0,) * 8, strict=True))
    base = BaseUnit(**exponents, factor=unit.factor, offset=unit.offset)
    return UnitDefinition(name=unit.name, base=base)


def unit_change(
    source: Endpoint, target: Endpoint, descriptions: Mapping[str, ModelDescription]
) -> str:
    """Such as "N to kN" where a wire converts units, else ""; raises `UnitError`."""
    described = ((end, descriptions[end.component]) for end in (source, target))
    first, second = (unit_of(d.variables.get(end.variable), d) for end, d in described)
    if first is None or second is None or conversion(first, second) == (1.0, 0.0):
        return ""
    return f"{first.name} to {second.name}"


def connectors(
    description: ModelDescription, used: Collection[str], version: str, units: Units
) -> tuple[Connector, ...]:
    """Connectors for the outputs of an FMU, and for inputs and other variables that are `used`.

    Inputs that nobody drives keep their start values and are not listed: FMPy drives one that is
    by what drives the one before it.
    """
    return tuple(
        Connector(
            name=v.name,
            kind=v.causality if v.causality != "independent" else "local",
            description=v.description or None,
            type=_type(v, description, version, units),
            dimensions=(Dimension(size=v.size),) if v.size > 1 and version != "1.0" else (),
        )
        for v in description.variables.values()
        if v.causality == "output" or v.name in used
    )


def _type(v: Variable, d: ModelDescription, version: str, units: Units) -> DataType | None:
    """The type of a connector; enumerations are left to the FMU, which defines them."""
    kind = _kind(v.type, version)
    if kind in ("Enumeration", "Binary") or kind not in KINDS:
        return None
    unit = units.name(unit_of(v, d)) if v.type in REAL_TYPES else None
    return DataType(tag=f"ssc:{kind}", unit=unit)


def _kind(fmi_type: str, version: str) -> str:
    """The name of an FMI type in SSP."""
    if version != "1.0":
        return fmi_type
    if fmi_type in REAL_TYPES:
        return "Real"
    return "Integer" if fmi_type in INTEGER_TYPES - {"Enumeration"} else fmi_type


def start_value_binding(
    name: str, values: Mapping[str, Any], description: ModelDescription, version: str
) -> tuple[ParameterBinding, ...]:
    """The binding that gives an FMU its start values; raises `ExperimentError`."""
    if not values:
        return ()
    parameters = tuple(_parameters(name, values, description, version))
    content = ParameterSet(version=version, name="start values", parameters=parameters)
    return (ParameterBinding(inline=content),)


def _parameters(
    name: str, values: Mapping[str, Any], description: ModelDescription, version: str
) -> Iterator[Parameter]:
    try:
        judged = judge_start_values(description, values, component=name)
    except UsageError as fault:
        raise ExperimentError(str(fault)) from fault
    for key, value in judged.told.items():
        target = find_target(description, key)
        assert target is not None, "it was judged"
        kind = target[0].type
        given = value if isinstance(value, list) else [value]
        written = _kind(kind if kind != "Enumeration" else "Int32", version)
        if kind == "Binary":
            raise ExperimentError(
                f"component {name}: start value of {key!r} is a binary, which this export cannot "
                "write; numbers, booleans, texts and enumerations it can"
            )
        several = (Dimension(size=len(given)),) if isinstance(value, list) else ()
        yield Parameter(name=key, value=_value(written, given), dimensions=several)


def _value(kind: str, given: list[Any]) -> ParameterValue:
    tag = f"ssv:{kind}"
    if kind == "String" and len(given) > 1:
        return ParameterValue(tag=tag, items=tuple(ValueItem(value=one) for one in given))
    return ParameterValue(tag=tag, value=" ".join(map(FORMS[KINDS[kind]].write, given)))
