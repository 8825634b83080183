"""Values of variables between Python and C: numbers, booleans, strings, binaries, arrays, clocks.

Pure conversions; nothing of an FMU is called here.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import FmuError
from harness.fmi.description.model_description import INTEGER_TYPES, REAL_TYPES, Variable

Value = float | int | bool | str | bytes
Values = Value | Sequence[Any] | NDArray[Any]

_WORDS = {"true": True, "false": False, "1": True, "0": False, "1.0": True, "0.0": False}
NATIVE_TYPES: dict[str, Any] = {
    "Float32": np.float32, "Float64": np.float64, "Real": np.float64, "Int8": np.int8,
    "UInt8": np.uint8, "Int16": np.int16, "UInt16": np.uint16, "Int32": np.int32,
    "UInt32": np.uint32, "Int64": np.int64, "UInt64": np.uint64, "Integer": np.int32,
    "Enumeration": np.int64, "Boolean": np.bool_, "Clock": np.bool_,
}  # fmt: skip


def native_dtype(variable: Variable) -> Any:
    """The numpy type that holds a variable exactly; `object` for strings and binaries."""
    return NATIVE_TYPES.get(variable.type, np.object_)


def to_c(variable: Variable, value: Values, ctype: Any, count: int, component: str) -> list[Any]:
    """`count` elements, of which a C array can be made; raises `FmuError` where `value` does not
    fit."""
    items = flat(value)
    if len(items) != count:
        raise FmuError(
            f"component {component}: variable {variable.name!r} has {count} element(s), "
            f"but {len(items)} value(s) were given"
        )
    try:
        made = [element(variable, item) for item in items]
        if variable.type in INTEGER_TYPES and list((ctype * count)(*made)) != made:
            raise OverflowError(value)  # C integers wrap silently
        return made
    except (TypeError, ValueError, KeyError, OverflowError) as fault:
        raise FmuError(
            f"component {component}: variable {variable.name!r} of type {variable.type} cannot be "
            f"set to {value!r}"
        ) from fault


def opposite(variable: Variable, value: Any) -> Any:
    """What a negated alias of FMI 1 has where its base has `value`: -x, of booleans not x."""
    return not value if variable.type == "Boolean" else -value


def flat(value: Values) -> list[Any]:
    """The elements of a value in row-major order."""
    if isinstance(value, np.ndarray):
        return list(value.ravel().tolist())
    if isinstance(value, (list, tuple)):
        return [item for part in value for item in flat(part)]
    return [value]


def from_c(variable: Variable, items: list[Any], shape: tuple[int, ...]) -> Any:
    """The Python value of what C has: one item, or for an array an ndarray of `shape`."""
    if variable.type in ("Boolean", "Clock"):
        items = list(map(bool, items))
    if not shape:
        return items[0]
    dtype = np.object_ if variable.type in ("String", "Binary") else None
    return np.array(items, dtype=dtype).reshape(shape)


def parse_value(variable: Variable, text: str, count: int = 1) -> Values:
    """The value that `text` means for a variable, as in a start attribute or a cell of a CSV file.

    Arrays are separated by spaces or commas, in row-major order; a binary is hexadecimal; an
    enumeration is a number or the name of an item; booleans are true, false, 1 or 0, in any
    case. Raises `FmuError` where the text means nothing.
    """
    words = text.replace(",", " ").split() if variable.dimensions or count > 1 else [text]
    try:
        values = [element(variable, word) for word in words]
    except (KeyError, ValueError, OverflowError) as fault:
        raise FmuError(
            f"variable {variable.name!r} of type {variable.type} cannot be {text!r}"
            + (f"; its items are {item_names(variable)}" if variable.details.items else "")
        ) from fault
    return values if variable.dimensions else values[0]


def element(variable: Variable, given: Any) -> Any:
    """One element of a variable, of a text or a value; raises KeyError, TypeError, ValueError or
    OverflowError where `given` means none."""
    if variable.type in REAL_TYPES:
        return float(given)
    if variable.type in INTEGER_TYPES:
        return _whole(variable, given)
    if variable.type in ("Boolean", "Clock"):
        return _WORDS[str(given).strip().lower()]
    if variable.type == "Binary":
        return bytes.fromhex(given) if isinstance(given, str) else bytes(given)
    return str(given)


def _whole(variable: Variable, given: Any) -> int:
    if isinstance(given, str):
        names = {name: number for number, name in variable.details.items}
        if given.strip() in names:
            return names[given.strip()]
        with suppress(ValueError):
            return int(given)
    if isinstance(given, (int, np.integer)):
        return int(given)
    if not float(given).is_integer():
        raise ValueError(given)
    return int(float(given))


def item_names(variable: Variable) -> str:
    """The items of an enumeration with their numbers, for a sentence; "" where there are none."""
    return ", ".join(f"{number} {name!r}" for number, name in variable.details.items[:12])
