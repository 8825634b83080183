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
from harness.system.units import BASE_UNITS, Unit, conversion


class Describer:
    """FMUs in the words of one `version` of SSP; gathers the units that are named on the way.

    Units of one name must mean the same. All methods raise `ExperimentError`.
    """

    def __init__(self, version: str) -> None:
        self.version = version
        self._known: dict[str, Unit] = {}

    def units(self) -> tuple[UnitDefinition, ...]:
        """All units named so far."""
        return tuple(_definition(unit) for unit in self._known.values())

    def connectors(self, d: ModelDescription, used: Collection[str]) -> tuple[Connector, ...]:
        """Connectors for the outputs of an FMU, and for inputs and other variables that are `used`.

        Inputs that nobody drives keep their start values and are not listed: FMPy drives one that
        is by what drives the one before it.
        """
        arrays = self.version != "1.0"
        return tuple(
            Connector(
                name=v.name,
                kind=v.causality if v.causality != "independent" else "local",
                description=v.description or None,
                type=self._type(v, d),
                dimensions=(Dimension(size=v.size),) if arrays and v.size > 1 else (),
            )
            for v in d.variables.values()
            if v.causality == "output" or v.name in used
        )

    def start_value_binding(
        self, component: str, values: Mapping[str, Any], d: ModelDescription
    ) -> tuple[ParameterBinding, ...]:
        """The binding that gives an FMU its start values."""
        if not values:
            return ()
        parameters = tuple(self._parameters(component, values, d))
        content = ParameterSet(version=self.version, name="start values", parameters=parameters)
        return (ParameterBinding(inline=content),)

    def _parameters(
        self, component: str, values: Mapping[str, Any], d: ModelDescription
    ) -> Iterator[Parameter]:
        try:
            judged = judge_start_values(d, values, component=component)
        except UsageError as fault:
            raise ExperimentError(str(fault)) from fault
        for key, value in judged.told.items():
            target = find_target(d, key)
            assert target is not None, "it was judged"
            if target[0].type == "Binary":
                raise ExperimentError(
                    f"component {component}: start value of {key!r} is a binary, which this export "
                    "cannot write; numbers, booleans, texts and enumerations it can"
                )
            kind = self._kind(target[0].type if target[0].type != "Enumeration" else "Int32")
            given = value if isinstance(value, list) else [value]
            several = (Dimension(size=len(given)),) if isinstance(value, list) else ()
            yield Parameter(name=key, value=_value(kind, given), dimensions=several)

    def _type(self, v: Variable, d: ModelDescription) -> DataType | None:
        """The type of a connector; enumerations are left to the FMU, which defines them."""
        kind = self._kind(v.type)
        if kind in ("Enumeration", "Binary") or kind not in KINDS:
            return None
        unit = self._unit(unit_of(v, d)) if v.type in REAL_TYPES else None
        return DataType(tag=f"ssc:{kind}", unit=unit)

    def _kind(self, fmi_type: str) -> str:
        """The name of an FMI type in SSP."""
        if self.version != "1.0":
            return fmi_type
        if fmi_type in REAL_TYPES:
            return "Real"
        return "Integer" if fmi_type in INTEGER_TYPES - {"Enumeration"} else fmi_type

    def _unit(self, unit: Unit | None) -> str | None:
        """The name to state, None where nothing defines the unit."""
        if unit is None or unit.exponents is None:
            return None
        if self._known.setdefault(unit.name, unit) != unit:
            raise ExperimentError(
                f"two FMUs define the unit {unit.name!r} differently; rename it in one of them"
            )
        return unit.name


def _definition(unit: Unit) -> UnitDefinition:
    exponents: dict[str, Any] = dict(zip(BASE_UNITS, unit.exponents or (0,) * 8, strict=True))
    base = BaseUnit(**exponents, factor=unit.factor, offset=unit.offset)
    return UnitDefinition(name=unit.name, base=base)


def _value(kind: str, given: list[Any]) -> ParameterValue:
    tag = f"ssv:{kind}"
    if kind == "String" and len(given) > 1:
        return ParameterValue(tag=tag, items=tuple(ValueItem(value=one) for one in given))
    return ParameterValue(tag=tag, value=" ".join(map(FORMS[KINDS[kind]].write, given)))


def unit_change(
    source: Endpoint, target: Endpoint, descriptions: Mapping[str, ModelDescription]
) -> str:
    """Such as "N to kN" where a wire converts units, else ""; raises `UnitError`."""
    described = ((end, descriptions[end.component]) for end in (source, target))
    first, second = (unit_of(d.variables.get(end.variable), d) for end, d in described)
    if first is None or second is None or conversion(first, second) == (1.0, 0.0):
        return ""
    return f"{first.name} to {second.name}"
