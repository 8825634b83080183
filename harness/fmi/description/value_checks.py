"""Judges what a model description states: names, references, units, limits and start values.

The faults are phrases for an `FmuError`, without the file's name. Nothing is allocated here,
whatever sizes a description claims. What the standard leaves to the FMU is left to it: several
variables may share a value reference where FMI 2 calls them aliases. A start value that an FMU
declares outside its own limits stops nobody; `fmu-harness validate` tells of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from harness.fmi.wording import shorten

if TYPE_CHECKING:
    from harness.fmi.description.model_description import Variable
    from harness.system.units import Unit

_TYPES: Mapping[str, Callable[[str], Any]] = {
    "Real": float, "Float32": float, "Float64": float, "Integer": int, "Enumeration": int,
    "Int8": int, "Int16": int, "Int32": int, "Int64": int, "UInt8": int, "UInt16": int,
    "UInt32": int, "UInt64": int,
}  # fmt: skip
_BOOLEANS = {"true": 1.0, "1": 1.0, "false": 0.0, "0": 0.0}


def variable_faults(variables: Mapping[str, Variable], fmi_major: int) -> Iterator[str]:
    """What is wrong with the variables, as phrases."""
    for v in variables.values():
        if None not in (v.minimum, v.maximum) and v.minimum > v.maximum:  # type: ignore[operator]
            yield f"has {_name(v)} with min {v.minimum:g} above max {v.maximum:g}"
        else:
            yield from _start_faults(v)
    if fmi_major == 2:
        yield from _alias_faults(variables)


def unit_faults(units: Mapping[str, Unit]) -> Iterator[str]:
    """What is wrong with the units: a factor of 0 or one that is not finite converts nothing."""
    for unit in units.values():
        if unit.factor == 0.0 or not math.isfinite(unit.factor) or not math.isfinite(unit.offset):
            yield (
                f"has the unit {shorten(unit.name)!r} with factor {unit.factor:g} and offset "
                f"{unit.offset:g}, by which nothing can be converted"
            )


def _start_faults(v: Variable) -> Iterator[str]:
    if v.start is None or (v.type not in _TYPES and v.type != "Boolean"):
        return
    items = v.start.split()
    if len(items) not in (1, v.size):
        yield f"has {_name(v)} of {v.size} element(s) with {len(items)} start value(s)"
        return
    for text in items:
        try:
            _BOOLEANS[text] if v.type == "Boolean" else _TYPES[v.type](text)
        except (ValueError, KeyError):
            yield f"has {_name(v)} of type {v.type} with the start value {shorten(text)!r}"
            return


def outside(v: Variable, value: float) -> str:
    """How `value` lies outside the limits of a variable, as in "above its max 3", or ""."""
    if v.minimum is not None and value < v.minimum:
        return f"below its min {v.minimum:g}"
    if v.maximum is not None and value > v.maximum:
        return f"above its max {v.maximum:g}"
    return ""


def _alias_faults(variables: Mapping[str, Variable]) -> Iterator[str]:
    """FMI 2: one value reference of one type is one value, so it can have one source only."""
    first: dict[tuple[str, int], Variable] = {}
    for v in variables.values():
        if v.causality != "input":
            continue
        base = "Integer" if v.type == "Enumeration" else v.type
        other = first.setdefault((base, v.value_reference), v)
        if other is not v:
            yield (
                f"has the inputs {_name(other)} and {_name(v)} with the same value reference "
                f"{v.value_reference}, so that one would overwrite the other"
            )


def _name(v: Variable) -> str:
    return repr(shorten(v.name))
