"""Float64 slots to and from the integers, booleans and floats of an FMU's C interface.

Reals, booleans and integers up to 32 bits are float64 inside the harness, 64-bit integers are
themselves. Rounding is to the
nearest, ties to even; a boolean is whatever is not zero. A number outside the range of its C type
is refused: it would come out as another one. C numbers lie in the buffer byte by byte, lowest
first, as on every machine served here; a view of the buffer as an array of another type would
cost atomic reference counting at each use.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.compiler import operations as op
from harness.compiler.machine_code import compiled

_SINGLE = 2.0**128 * (1.0 - 2.0**-25)  # from here on the nearest float32 is infinity
_LOWEST = (
    -np.inf, -(2.0**7), 0.0, -(2.0**15), 0.0, -(2.0**31), 0.0, -(2.0**63), 0.0,
    -_SINGLE * (1.0 - 2.0**-52), -np.inf,
)  # fmt: skip
_BEYOND = (
    np.inf, 2.0**7, 2.0**8, 2.0**15, 2.0**16, 2.0**31, 2.0**32, 2.0**63, 2.0**64,
    _SINGLE, np.inf,
)  # fmt: skip
"""By kind: the lowest number that it holds, and the first one beyond the highest."""

_SIZE = op.ITEM_SIZE
_BOOLEAN = tuple(kind in (op.BOOL8, op.BOOL32) for kind in range(len(_SIZE)))
_SIGNED = tuple(kind in (op.INT8, op.INT16, op.INT32, op.INT64) for kind in range(len(_SIZE)))


@compiled
def encode(kind: int, v: Any, first: int, last: int, exchange: Any, start: int) -> bool:
    """Write slots first..last-1 of `v` as C numbers of `kind` from byte `start` of `exchange`.

    False when one of them is out of range; then nothing may be read from there.
    """
    place, size = start, _SIZE[kind]
    for slot in range(first, last):
        if not _LOWEST[kind] <= np.rint(v[slot]) < _BEYOND[kind]:
            return False
        if _BOOLEAN[kind]:
            bits = np.int64(v[slot] != 0.0)
        elif kind == op.FLOAT32:
            bits = np.int64(np.float32(v[slot]).view(np.int32))
        elif kind == op.UINT64:
            bits = np.int64(np.uint64(np.rint(v[slot])))
        else:
            bits = np.int64(np.rint(v[slot]))
        for i in range(size):
            exchange[place + i] = bits & 0xFF
            bits >>= 8
        place += size
    return True


@compiled
def decode(kind: int, v: Any, first: int, last: int, exchange: Any, start: int) -> None:
    """Read C numbers of `kind` from byte `start` of `exchange` into slots first..last-1 of `v`."""
    place, size = start, _SIZE[kind]
    unused = 8 * (8 - size)
    for slot in range(first, last):
        bits = np.int64(0)
        for i in range(size):
            bits |= np.int64(exchange[place + i]) << (8 * i)
        place += size
        if _BOOLEAN[kind]:
            v[slot] = 1.0 if bits != 0 else 0.0
        elif kind == op.FLOAT32:
            v[slot] = float(np.int32(bits).view(np.float32))
        elif kind == op.UINT64:
            v[slot] = float(np.uint64(bits))
        elif _SIGNED[kind]:
            v[slot] = float((bits << unused) >> unused)
        else:
            v[slot] = float(bits)


@compiled
def convert(copies: Any, scales: Any, v: Any, wide: Any, first: int, last: int) -> bool:
    """Copy entries first..last-1 of the flat table, each by its conversion; `wide` are the cells of
    `v` as int64. False where a number does not fit: it is the first whose target was left alone."""
    for i in range(first, last):
        source, target, how = copies[3 * i], copies[3 * i + 1], copies[3 * i + 2]
        factor, offset = scales[2 * i], scales[2 * i + 1]
        plain = factor == 1.0 and offset == 0.0
        bits = wide[source]
        if how == op.EXACT and plain:
            wide[target] = bits
            continue
        if (how == op.INT64_TO_UINT64 or how == op.UINT64_TO_INT64) and plain:
            if bits < 0:
                return False
            wide[target] = bits
            continue
        value = v[source]
        if how == op.FROM_INT64 or how == op.INT64_TO_UINT64:
            value = float(bits)
        elif how == op.FROM_UINT64 or how == op.UINT64_TO_INT64:
            value = float(np.uint64(bits))
        value = factor * value + offset
        if how == op.ROUND:
            whole = np.rint(value)
            v[target] = whole if whole != 0.0 else 0.0  # of integers there is one zero
        elif how == op.TRUTH:
            v[target] = 1.0 if value != 0.0 else 0.0
        elif how == op.SINGLE:
            v[target] = float(np.float32(value))
        elif how == op.TO_INT64 or how == op.UINT64_TO_INT64:
            value = np.rint(value)
            if not -(2.0**63) <= value < 2.0**63:
                return False
            wide[target] = np.int64(value)
        elif how == op.TO_UINT64 or how == op.INT64_TO_UINT64:
            value = np.rint(value)
            if not 0.0 <= value < 2.0**64:
                return False
            wide[target] = np.int64(np.uint64(value))
        else:
            v[target] = value
    return True
