"""Values of variables between Python and C: numbers, booleans, strings, binaries, arrays, clocks.

Pure conversions; nothing of an FMU is called here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
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
    """`count` elements as C holds them; raises `FmuError` where `value` does not fit."""
    items = flat(value)
    if len(items) != count:
        raise FmuError(
            f"component {component}: variable {variable.name!r} has {count} element(s), "
            f"but {len(items)} value(s) were given"
        )
    try:
        made = [_to_c(variable, item) for item in items]
        held = list((ctype * count)(*made))
        if variable.type in INTEGER_TYPES and held != made:  # C integers wrap silently
            raise ValueError(value)
        return held
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


def _to_c(variable: Variable, value: Any) -> Any:
    if variable.type in REAL_TYPES:
        return float(value)
    if variable.type in INTEGER_TYPES:
        whole = int(value)
        if not isinstance(value, (int, str)) and float(value) != whole:
            raise ValueError(value)
        return whole
    if variable.type in ("Boolean", "Clock"):
        return _WORDS[str(value).strip().lower()]
    if variable.type == "String":
        return str(value).encode()
    if variable.type == "Binary":
        return bytes.fromhex(value) if isinstance(value, str) else bytes(value)
    raise TypeError(variable.type)


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
        values = [parse_item(variable, word) for word in words]
    except (KeyError, ValueError, OverflowError) as fault:
        raise FmuError(
            f"variable {variable.name!r} of type {variable.type} cannot be {text!r}"
            + (f"; its items are {item_names(variable)}" if variable.details.items else "")
        ) from fault
    return values if variable.dimensions else values[0]


def parse_item(variable: Variable, word: str) -> Any:
    """One element of `parse_value`; raises KeyError, ValueError or OverflowError."""
    if variable.type in REAL_TYPES:
        return float(word)
    if variable.type in INTEGER_TYPES:
        return _whole(variable, word.strip())
    if variable.type in ("Boolean", "Clock"):
        return _WORDS[word.strip().lower()]
    if variable.type == "Binary":
        return bytes.fromhex(word)
    return word


def _whole(variable: Variable, word: str) -> int:
    for number, name in variable.details.items:
        if word == name:
            return number
    try:
        return int(word)
    except ValueError:
        number_ = float(word)
        if not math.isfinite(number_) or number_ != int(number_):
            raise
        return int(number_)


def item_names(variable: Variable) -> str:
    """The items of an enumeration with their numbers, for a sentence; "" where there are none."""
    return ", ".join(f"{number} {name!r}" for number, name in variable.details.items[:12])
