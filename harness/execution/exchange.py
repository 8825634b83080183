"""Float64 slots to and from the integers, booleans and floats of an FMU's C interface.

Signals are float64 inside the harness: whole numbers up to 2^53 are exact. Rounding is to the
nearest, ties to even; a boolean is whatever is not zero. C numbers lie in the buffer byte by
byte, lowest first, as on every machine served here; a view of the buffer as an array of another
type would cost atomic reference counting at each use.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from harness.execution import operations as op

_SIGNED = tuple(kind in (op.INT8, op.INT16, op.INT32, op.INT64) for kind in range(10))
_SIZE = op.ITEM_SIZE


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def encode(kind: int, v: Any, first: int, last: int, exchange: Any, start: int) -> None:
    """Write slots first..last-1 of `v` as C numbers of `kind` from byte `start` of `exchange`."""
    place, size = start, _SIZE[kind]
    for slot in range(first, last):
        if kind == op.BOOL8:
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


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def decode(kind: int, v: Any, first: int, last: int, exchange: Any, start: int) -> None:
    """Read C numbers of `kind` from byte `start` of `exchange` into slots first..last-1 of `v`."""
    place, size = start, _SIZE[kind]
    unused = 8 * (8 - size)
    for slot in range(first, last):
        bits = np.int64(0)
        for i in range(size):
            bits |= np.int64(exchange[place + i]) << (8 * i)
        place += size
        if kind == op.BOOL8:
            v[slot] = 1.0 if bits != 0 else 0.0
        elif kind == op.FLOAT32:
            v[slot] = float(np.int32(bits).view(np.float32))
        elif kind == op.UINT64:
            v[slot] = float(np.uint64(bits))
        elif _SIGNED[kind]:
            v[slot] = float((bits << unused) >> unused)
        else:
            v[slot] = float(bits)
