"""Judges the start values that a caller gives to an FMU's variables, before anything is loaded.

Each fault is a sentence that names component and variable, what was expected and what was given.
The number of elements of an array is left to the instance, since structural parameters change it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from harness.errors import nearest
from harness.fmi.description.model_description import (
    INTEGER_TYPES,
    REAL_TYPES,
    ModelDescription,
    Variable,
)
from harness.fmi.description.value_checks import outside

_BITS = {"Integer": (True, 32), "Enumeration": (True, 64)} | {
    f"{sign}Int{bits}": (not sign, bits) for sign in ("", "U") for bits in (8, 16, 32, 64)
}
_BOOLEANS = ("true", "false", "1", "0")


def start_value_faults(
    component: str, values: Mapping[str, Any], description: ModelDescription
) -> Iterator[str]:
    """One sentence for each start value that cannot be meant."""
    for name, value in values.items():
        if name not in description.variables:
            hint = nearest(name, description.variables)
            yield f"component {component}: no variable {name!r} to give a start value; {hint}"
            continue
        variable = description.variables[name]
        fault = _not_settable(variable) or next(
            filter(None, (_fault(variable, item) for item in _items(value))), ""
        )
        if fault:
            yield f"component {component}: start value of {name!r} {fault}"


def _not_settable(v: Variable) -> str:
    if v.variability == "constant" or v.causality == "independent":
        what = "a constant" if v.variability == "constant" else "the independent variable"
        return f"cannot be set, for it is {what}"
    if v.initial == "calculated":
        return f"cannot be set, for the FMU calculates it (causality {v.causality})"
    return ""


def _items(value: Any) -> Iterator[Any]:
    if isinstance(value, (list, tuple, np.ndarray)):
        for item in value:
            yield from _items(item)
    else:
        yield value


def _fault(v: Variable, value: Any) -> str:
    if v.type in REAL_TYPES or v.type in INTEGER_TYPES:
        return _number_fault(v, value)
    if v.type == "Boolean" and str(value).lower() not in _BOOLEANS:
        return f"must be true or false, not {value!r}"
    if v.type == "String" and not isinstance(value, str):
        return f"must be text, not {value!r}"
    return ""


def _number_fault(v: Variable, value: Any) -> str:
    number = isinstance(value, (int, float, np.integer, np.floating))
    if not number or isinstance(value, (bool, np.bool_)):
        return f"must be a number ({v.type}), not {value!r}"
    try:
        if not math.isfinite(value):
            return f"must be finite, not {value}"
    except OverflowError:
        return f"must be finite, not a number of {len(str(value))} digits"
    if v.type in INTEGER_TYPES:
        if value != int(value):
            return f"must be a whole number ({v.type}), not {value!r}"
        signed, bits = _BITS[v.type]
        first, last = (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if signed else (0, 2**bits - 1)
        if not first <= value <= last:
            return f"must be between {first} and {last} ({v.type}), not {value!r}"
    elif v.type == "Float32" and abs(float(value)) > float(np.finfo(np.float32).max):
        return f"must fit Float32, not {value!r}"
    beyond = outside(v, float(value))
    return f"is {value!r}, {beyond}" if beyond else ""
