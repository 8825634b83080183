"""Calling a Python function of floats from compiled code, by the interpreter's own C functions:
ctypes' callbacks take three times as long, and lose what the function raises.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types

from harness.compiler.calls import calling, integers, reals
from harness.compiler.machine_code import cached_callback, inlined
from harness.compiler.operations import INSTANT

_FUNCTIONS = (
    "PyGILState_Ensure", "PyGILState_Release", "PyFloat_FromDouble", "PyFloat_AsDouble",
    "PyObject_Vectorcall", "Py_DecRef", "PyObject_Type", "PyErr_Fetch", "PyErr_NormalizeException",
    "PyException_SetTraceback",
)  # fmt: skip
(
    ENSURE, RELEASE, FROM_DOUBLE, AS_DOUBLE, CALL, FORGET, TYPE_OF, FETCH, NORMALIZE,
    SET_TRACEBACK, FUNCTION, FAILED, NUMBER, FLOAT, CLOCK, TICKS, INPUTS, N, OUTPUT, RESULT, KIND,
    FAULT, TRACEBACK, ARGUMENTS,
) = range(24)  # fmt: skip
"""Cells of a context: addresses of functions, what is called, where numbers lie, what was raised,
and from `ARGUMENTS` on those of a call."""

_FAULT = 3
_WHOLE, _VOID, _REAL = ir.IntType(64), ir.VoidType(), ir.DoubleType()
_object = calling(_WHOLE, types.int64)
_small = calling(ir.IntType(32), types.int32)
_nothing = calling(_VOID, types.void)
_real = calling(_REAL, types.float64)


class PythonCall:
    """`function(time, *inputs)`, whose result is stored where `output` is an address; `failed` is
    called with what it raises. `number` makes a float of a result that is none, or raises why it
    cannot.

    `address` is that of a C function `int32 f(int64 context, int64)`: 0, or 3 after a failure.
    The inputs are `n` float64 at the address `inputs`; the time (s) is that of the loop's `clock`,
    of which `ticks` are a second.
    """

    def __init__(
        self, function: Callable[..., Any], failed: Callable[[BaseException], None], clock: int,
        ticks: float, inputs: int, n: int, output: int = 0, number: Callable[[Any], float] = float,
    ) -> None:  # fmt: skip
        """What C holds addresses of lives as long as this."""
        self._alive = function, failed, number
        self._cells = cells = np.zeros(ARGUMENTS + 1 + n, dtype=np.int64)
        cells[: len(_FUNCTIONS)] = [_address(name) for name in _FUNCTIONS]
        cells[FUNCTION], cells[FAILED] = id(function), id(failed)
        cells[NUMBER], cells[FLOAT] = id(number), id(float)
        cells[CLOCK], cells[INPUTS], cells[N], cells[OUTPUT] = clock, inputs, n, output
        cells.view(np.float64)[TICKS] = ticks
        self.address, self.context = _code().address, int(cells.ctypes.data)


def _address(name: str) -> int:
    return ctypes.cast(getattr(ctypes.pythonapi, name), ctypes.c_void_p).value or 0


@cache
def _code() -> Any:
    return cached_callback(call_python, types.int32(types.int64, types.int64))


def call_python(context: int, unused: int) -> int:
    """What C calls."""
    c = integers(context)
    lock = _small(c[ENSURE], (0,))
    arguments, inputs, n = integers(context + 8 * ARGUMENTS), reals(c[INPUTS]), c[N]
    time = integers(c[CLOCK])[INSTANT] / reals(context)[TICKS]
    arguments[0] = _object(c[FROM_DOUBLE], (time,))
    for i in range(n):
        arguments[i + 1] = _object(c[FROM_DOUBLE], (inputs[i],))
    result = _object(c[CALL], (c[FUNCTION], context + 8 * ARGUMENTS, n + 1, 0))
    if result != 0 and c[OUTPUT] != 0:
        kind = _object(c[TYPE_OF], (result,))
        if kind != c[FLOAT]:
            c[RESULT] = result
            result = _object(c[CALL], (c[NUMBER], context + 8 * RESULT, 1, 0))
            _nothing(c[FORGET], (c[RESULT],))
        _nothing(c[FORGET], (kind,))
        if result != 0:
            reals(c[OUTPUT])[0] = _real(c[AS_DOUBLE], (result,))
    fine = result != 0
    _nothing(c[FORGET], (result,))
    for i in range(n + 1):
        _nothing(c[FORGET], (arguments[i],))
    if not fine:
        _tell(context)
    _nothing(c[RELEASE], (lock,))
    return 0 if fine else _FAULT


@inlined
def _tell(context: int) -> None:
    """Call `failed` with what was raised."""
    c, places = (
        integers(context),
        (context + 8 * KIND, context + 8 * FAULT, context + 8 * TRACEBACK),
    )
    _nothing(c[FETCH], places)
    _nothing(c[NORMALIZE], places)
    if c[TRACEBACK] != 0:
        _small(c[SET_TRACEBACK], (c[FAULT], c[TRACEBACK]))
    done = _object(c[CALL], (c[FAILED], context + 8 * FAULT, 1, 0))
    for one in (done, c[KIND], c[FAULT], c[TRACEBACK]):
        _nothing(c[FORGET], (one,))
