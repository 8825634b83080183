"""What a value that a user gives means for a variable: its elements, in its type and unit.

The faults are phrases that go on after "start value of 'x'".
"""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

from harness.errors import UnitError
from harness.fmi.binding.values import element, flat, item_names, native_dtype
from harness.fmi.description.model_description import (
    INTEGER_TYPES,
    REAL_TYPES,
    ModelDescription,
    Variable,
    outside,
)
from harness.fmi.wording import shorten
from harness.system.units import conversion, parse_unit

NUMBERS = REAL_TYPES | INTEGER_TYPES
_SEQUENCES = (list, tuple, np.ndarray)
_WITH_UNIT = re.compile(r"^(.*?)\s*\[([^\]]+)\]\s*$")
_EXPECTED = {
    "Boolean": "true or false", "Clock": "true or false", "String": "text",
    "Binary": "bytes or hexadecimal text",
}  # fmt: skip


def elements_meant(
    d: ModelDescription, v: Variable, value: Any, shape: tuple[int, ...]
) -> list[Any]:
    """The elements in row-major order that `value` means for `v`, or with the shape () for one
    element of it, in its type and unit; raises ValueError with what is wrong, as a phrase."""
    value, unit = _without_unit(v, value, shape)
    if isinstance(value, str) and shape:
        value = value.replace(",", " ").split()
    nested = np.shape(np.array(value, dtype=object)) if isinstance(value, _SEQUENCES) else ()
    items = [_item(v, one) for one in flat(value)]
    if len(items) != math.prod(shape) or (len(nested) > 1 and nested != shape):
        received = sizes_text(nested) if len(nested) > 1 else len(items)
        raise ValueError(f"must have {sizes_text(shape) or 1} element(s), not {received}")
    if unit is not None:
        items = [_in_unit_of(d, v, one, unit) for one in items]
    return [_in_range(v, one) for one in items]


def _without_unit(v: Variable, value: Any, shape: tuple[int, ...]) -> tuple[Any, str | None]:
    """Value and unit of a pair (value, unit) or of a text "value [unit]"."""
    if v.type in ("String", "Binary"):
        return value, None
    if isinstance(value, str):
        match = _WITH_UNIT.match(value)
        named = value in dict(v.details.items).values()
        return (match[1], match[2].strip()) if match and not named else (value, None)
    pair = isinstance(value, (tuple, list)) and len(value) == 2 and isinstance(value[1], str)
    if pair and not (shape and isinstance(value[0], str)):  # else two elements, as texts
        return value[0], value[1]
    return value, None


def _item(v: Variable, item: Any) -> Any:
    """One element in the type of `v`, whatever its range; raises ValueError."""
    made = item.item() if isinstance(item, np.generic) else item
    try:
        if not _is_legal(v, made):
            raise TypeError(v.type)
        if isinstance(made, float) and not math.isfinite(made):
            raise OverflowError(made)
        return element(v, made)
    except OverflowError:
        raise ValueError(f"must be finite, not {_shown(made)}") from None
    except (KeyError, TypeError, ValueError):
        raise ValueError(f"must be {_expected(v)}, not {_shown(made)}") from None


def _is_legal(v: Variable, made: Any) -> bool:
    """Whether values of the type of `made`, or texts, are given for `v`."""
    if isinstance(made, str) or v.type in ("Boolean", "Clock"):
        return True
    kinds = {"String": (), "Binary": (bytes, bytearray)}
    return isinstance(made, kinds.get(v.type, (int, float))) and type(made) is not bool


def _in_range(v: Variable, value: Any) -> Any:
    """A number as the type of `v` holds it, others as they are; raises ValueError."""
    if v.type not in NUMBERS:
        return value
    dtype = native_dtype(v)
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"must be finite, not {value}")
    if v.type in REAL_TYPES:
        if abs(value) > float(np.finfo(dtype).max):
            raise ValueError(f"must fit {v.type}, not {value!r}")
        return value
    if v.details.items and value not in dict(v.details.items):
        raise ValueError(f"must be {_expected(v)}, not {_shown(value)}")
    first, last = int(np.iinfo(dtype).min), int(np.iinfo(dtype).max)
    if not first <= value <= last:
        raise ValueError(f"must be between {first} and {last} ({v.type}), not {_shown(value)}")
    return value


def beyond_limits(v: Variable, value: Any) -> str:
    """How an element lies outside the min and max of `v`, as a phrase, or ""."""
    fault = outside(v, value) if v.type in NUMBERS else ""
    return f"is {repr(value).removesuffix('.0')}, {fault}" if fault else ""


def _in_unit_of(d: ModelDescription, v: Variable, value: Any, unit: str) -> Any:
    """`value` in `unit`, converted to the unit of `v`; raises ValueError where it cannot be."""
    if v.type not in REAL_TYPES:
        raise ValueError(f"of type {v.type} has no unit, but {unit!r} was given")
    if not v.unit:
        raise ValueError(f"has no unit, but {unit!r} was given")
    if unit == v.unit:
        return value
    shown = d.display_units.get(v.unit, {})
    if unit in shown:
        one = shown[unit]
        if one.inverse:
            return one.factor / value if value else math.inf
        return (value - (0.0 if v.details.relative else one.offset)) / one.factor
    try:
        factor, offset = conversion(parse_unit(unit, d.units), parse_unit(v.unit, d.units))
    except UnitError as fault:
        known = f"; give it in {', '.join(dict.fromkeys((v.unit or 'its own unit', *shown)))}"
        raise ValueError(f"cannot be in {unit!r}: {fault}{known}") from fault
    return factor * value + (0.0 if v.details.relative else offset)


def _expected(v: Variable) -> str:
    if v.details.items:
        return f"one of {item_names(v)}"
    number = "a number" if v.type in REAL_TYPES else "a whole number"
    return _EXPECTED.get(v.type, f"{number} ({v.type})")


def _shown(value: Any) -> str:
    if isinstance(value, int) and value.bit_length() > 400:
        return f"a number of {int(value.bit_length() * math.log10(2)) + 1} digits"
    return shorten(repr(value))


def sizes_text(shape: tuple[int, ...]) -> str:
    """The sizes of an array for a sentence, such as "2 by 3"."""
    return " by ".join(map(str, shape))
