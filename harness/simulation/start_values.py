"""Start values: from text or Python values, in any unit, to what the FMU is told.

    h=2            in the variable's own unit
    h=3 [ft]       in another one, converted by the FMU's units, its display units, or known ones
    A=1 0 0 1      all elements of an array, in row-major order
    A[2,1]=0.5     one element; the others keep their start values

Differences (`relativeQuantity`) are converted without the offset: 20 °C of heating are 20 K.
Structural parameters of FMI 3 are set first, since they give arrays their sizes.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.errors import UnitError, UsageError, nearest
from harness.fmi.binding.fmi3 import Fmi3Instance
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.values import Values, flat, parse_value
from harness.fmi.description.model_description import (
    INTEGER_TYPES,
    REAL_TYPES,
    ModelDescription,
    Variable,
)
from harness.fmi.description.value_checks import outside
from harness.system.units import conversion, parse_unit

_ELEMENT = re.compile(r"^(.*)\[(\d+(?:\s*,\s*\d+)*)\]$")


@dataclass(frozen=True)
class StartValue:
    """A value, text or number(s), in `unit` (None: the variable's own)."""

    value: Values
    unit: str | None = None


def parse_assignment(d: ModelDescription, text: str) -> tuple[str, StartValue]:
    """The name and value of "name=value" or "name=value[unit]"; raises `UsageError`."""
    name, equals, value = _split(d, text)
    if not equals or not name:
        raise UsageError(f"start value {text!r} must have the form name=value or name=value[unit]")
    match = re.match(r"^(.*?)\s*\[([^\]]+)\]\s*$", value)
    found = StartValue(match[1].strip(), match[2].strip()) if match else StartValue(value)
    return name, found


def _split(d: ModelDescription, text: str) -> tuple[str, str, str]:
    """At the "=" that leaves a name of the FMU before it; names may hold one themselves."""
    places = [i for i, letter in enumerate(text) if letter == "="]
    for place in places:
        name = text[:place].strip()
        if name in d.variables:
            return name, "=", text[place + 1 :]
    name, equals, value = text.partition("=")
    return name.strip(), equals, value


def set_start_values(
    instance: FmuInstance, given: Mapping[str, Any], notes: list[str] | None = None
) -> None:
    """Set the start values before initialisation; raises `UsageError` or `FmuError` naming what
    cannot be set. Values are numbers, texts, arrays, pairs (value, unit) or `StartValue`. One
    outside the variable's limits is refused, or set and told in `notes` where there are any."""
    resolved = {name: _given(value) for name, value in given.items()}
    structural: dict[str, int] = {}
    for name, start in resolved.items():
        variable = instance.description.variables.get(name)
        if variable is not None and variable.causality == "structuralParameter":
            size = _converted(instance, variable, start)
            _check_limits(name, variable, size, notes)
            structural[name] = int(flat(size)[0])
    if structural:
        if not isinstance(instance, Fmi3Instance):
            raise UsageError("structural parameters exist in FMI 3 only")
        instance.configure(structural)
    arrays: dict[str, Any] = {}
    for name, start in resolved.items():
        if name in structural:
            continue
        variable, index = _target(instance, name)
        _check_settable(instance.description, variable)
        value = _converted(instance, variable, start, element=index is not None)
        _check_limits(name, variable, value, notes)
        if index is None:
            instance.set({variable.name: value})
        else:
            if variable.name not in arrays:
                arrays[variable.name] = np.array(instance.get(variable.name))
            arrays[variable.name][index] = flat(value)[0]
    instance.set(arrays)


def _given(value: Any) -> StartValue:
    if isinstance(value, StartValue):
        return value
    if isinstance(value, tuple) and len(value) == 2 and isinstance(value[1], str):
        return StartValue(value[0], value[1])
    return StartValue(value)


def _target(instance: FmuInstance, name: str) -> tuple[Variable, tuple[int, ...] | None]:
    """The variable called `name`, or the array and the place of the element that it names."""
    d = instance.description
    if name in d.variables:
        return d.variables[name], None
    match = _ELEMENT.match(name)
    if match and match[1] in d.variables:
        variable = d.variables[match[1]]
        shape = instance.shape(variable)
        index = tuple(int(one) - 1 for one in match[2].split(","))
        inside = len(index) == len(shape) and all(
            0 <= i < n for i, n in zip(index, shape, strict=False)
        )
        if not inside:
            raise UsageError(
                f"{name!r} is no element of {variable.name!r}, whose sizes are "
                f"{' by '.join(map(str, shape)) or 'those of a scalar'}"
            )
        return variable, index
    raise UsageError(f"FMU {d.name} has no variable {name!r}; {nearest(name, d.variables)}")


def _check_settable(d: ModelDescription, v: Variable) -> None:
    fixed = v.variability == "constant" or v.causality in ("independent", "calculatedParameter")
    computed = d.fmi_major > 1 and v.causality != "input" and v.initial not in ("exact", "approx")
    if fixed or computed:
        why = f"a {v.variability}" if v.variability == "constant" else "calculated by the FMU"
        settable = [
            n for n, o in d.variables.items()
            if o.initial in ("exact", "approx") and o.variability != "constant"
        ]  # fmt: skip
        raise UsageError(
            f"variable {v.name!r} takes no start value: it is {why}; {nearest(v.name, settable)}"
        )


def _check_limits(name: str, v: Variable, value: Values, notes: list[str] | None) -> None:
    if v.type not in REAL_TYPES and v.type not in INTEGER_TYPES:
        return
    for number in flat(value):
        fault = outside(v, float(number))
        if fault and notes is None:
            raise UsageError(
                f"start value of {name!r} is {number}, {fault}; --no-validate (validate=False) "
                "sets it all the same"
            )
        if fault and notes is not None:
            notes.append(f"start value of {name!r} is {number}, {fault}")


def _converted(
    instance: FmuInstance, v: Variable, start: StartValue, *, element: bool = False
) -> Values:
    value = start.value
    if isinstance(value, str):
        if element:
            value = flat(parse_value(v, value.strip()))
        elif v.type == "String" and not v.dimensions:
            pass
        else:
            value = parse_value(v, value.strip())
    if start.unit is None:
        return value
    if v.type not in REAL_TYPES:
        raise UsageError(
            f"variable {v.name!r} of type {v.type} has no unit, but {start.unit!r} was given"
        )
    try:
        numbers = [in_unit_of(instance.description, v, float(x), start.unit) for x in flat(value)]
    except ValueError as fault:
        raise UsageError(f"variable {v.name!r} cannot be {value!r} {start.unit}") from fault
    return numbers if v.dimensions and not element else numbers[0]


def in_unit_of(d: ModelDescription, v: Variable, value: float, unit: str) -> float:
    """`value` in `unit`, converted to the unit of `v`; raises `UsageError` where it cannot be."""
    if unit == v.unit:
        return value
    if not v.unit:
        raise UsageError(
            f"variable {v.name!r} has no unit, but its start value was given in {unit!r}"
        )
    shown = d.display_units.get(v.unit, {}).get(unit)
    if shown is not None:
        if shown.inverse:
            return shown.factor / value
        return (value - (0.0 if v.details.relative else shown.offset)) / shown.factor
    try:
        factor, offset = conversion(parse_unit(unit, d.units), parse_unit(v.unit, d.units))
    except UnitError as fault:
        known = ", ".join(d.display_units.get(v.unit, {}))
        raise UsageError(
            f"start value of {v.name!r}: {fault}" + (f"; it is shown in {known}" if known else "")
        ) from fault
    return factor * value + (0.0 if v.details.relative else offset)
