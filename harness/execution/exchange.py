"""Float64 slots to and from the integers, booleans and floats of an FMU's C interface.

Signals are float64 inside the harness: whole numbers up to 2^53 are exact. Rounding is to the
nearest, ties to even; a boolean is whatever is not zero.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from harness.execution import operations as op


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def encode(kind: int, values: Any, exchange: Any, start: int) -> None:
    """Write float64 `values` (n,) as C numbers of `kind` from byte `start` (a multiple of 8)."""
    space = exchange[start:]
    for i in range(values.shape[0]):
        if kind == op.BOOL8:
            space[i] = np.uint8(values[i] != 0.0)
        elif kind == op.BOOL32:
            space.view(np.uint32)[i] = np.uint32(values[i] != 0.0)
        elif kind == op.INT8 or kind == op.UINT8:
            space[i] = np.uint8(np.int64(np.rint(values[i])) & 0xFF)
        elif kind == op.INT16 or kind == op.UINT16:
            space.view(np.uint16)[i] = np.uint16(np.int64(np.rint(values[i])) & 0xFFFF)
        elif kind == op.INT32 or kind == op.UINT32:
            space.view(np.uint32)[i] = np.uint32(np.int64(np.rint(values[i])) & 0xFFFFFFFF)
        elif kind == op.FLOAT32:
            space.view(np.float32)[i] = np.float32(values[i])
        elif kind == op.UINT64:
            space.view(np.uint64)[i] = np.uint64(np.rint(values[i]))
        else:
            space.view(np.int64)[i] = np.int64(np.rint(values[i]))


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def decode(kind: int, values: Any, exchange: Any, start: int) -> None:
    """Read C numbers of `kind` from byte `start` (a multiple of 8) into float64 `values` (n,)."""
    space = exchange[start:]
    for i in range(values.shape[0]):
        if kind == op.BOOL8:
            values[i] = 1.0 if space[i] != 0 else 0.0
        elif kind == op.BOOL32:
            values[i] = 1.0 if space.view(np.uint32)[i] != 0 else 0.0
        elif kind == op.UINT8:
            values[i] = float(space[i])
        elif kind == op.INT8:
            values[i] = float(space.view(np.int8)[i])
        elif kind == op.INT16:
            values[i] = float(space.view(np.int16)[i])
        elif kind == op.UINT16:
            values[i] = float(space.view(np.uint16)[i])
        elif kind == op.INT32:
            values[i] = float(space.view(np.int32)[i])
        elif kind == op.UINT32:
            values[i] = float(space.view(np.uint32)[i])
        elif kind == op.FLOAT32:
            values[i] = float(space.view(np.float32)[i])
        elif kind == op.UINT64:
            values[i] = float(space.view(np.uint64)[i])
        else:
            values[i] = float(space.view(np.int64)[i])
