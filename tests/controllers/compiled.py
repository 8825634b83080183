"""Compile a block's step function as the harness does, and compare it with the interpreted one."""

from __future__ import annotations

import types
from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from numba import carray
from numba import types as nb

from controllers.core.block import Array, Block

_REBUILT: dict[Any, Any] = {}  # njit twins of the plain functions, shared by all blocks


def rebuild(function: Callable[..., Any], done: dict[Any, Any]) -> Any:
    """`function` and every plain Python function it names, as numba njit functions."""
    if function in done:
        return done[function]
    scope = dict(function.__globals__)
    for name in function.__code__.co_names:
        value = scope.get(name)
        if isinstance(value, types.FunctionType):
            scope[name] = rebuild(value, done)
    copy = types.FunctionType(function.__code__, scope, function.__name__)
    done[function] = numba.njit(error_model="numpy")(copy)
    return done[function]


def compile_block(block: Block) -> tuple[Any, Callable[[Array, Array, Array, Array], int]]:
    """The C function (kept alive by the caller) and a call that takes arrays."""
    kernel = rebuild(block.step, _REBUILT)
    sizes = (len(block.parameters), len(block.state), len(block.inputs), len(block.outputs))
    n_p, n_x, n_u, n_y = sizes
    pointer = nb.CPointer(nb.float64)

    @numba.cfunc(nb.int32(pointer, pointer, pointer, pointer), error_model="numpy")
    def native(p, x, u, y):  # type: ignore[no-untyped-def]
        kernel(carray(p, (n_p,)), carray(x, (n_x,)), carray(u, (n_u,)), carray(y, (n_y,)))
        return 0

    def call(*arrays: Array) -> int:
        return int(native.ctypes(*(a.ctypes.data_as(pointer_type) for a in arrays)))

    pointer_type = native.ctypes.argtypes[0]
    return native, call


def assert_bit_equal(block: Block, inputs: Array) -> Array:
    """Run both over `inputs` (k, n_u), compare state and outputs bit by bit, return outputs."""
    keep, compiled = compile_block(block)
    p = block.parameters.copy()
    x_c, x_i = block.state.copy(), block.state.copy()
    y_c, y_i = np.zeros(len(block.outputs)), np.zeros(len(block.outputs))
    rows = np.empty((len(inputs), len(block.outputs)))
    for k, u in enumerate(inputs):
        given = np.ascontiguousarray(u)
        assert compiled(p, x_c, given, y_c) == 0
        block.step(p, x_i, given, y_i)
        assert y_c.tobytes() == y_i.tobytes(), (k, np.flatnonzero(y_c != y_i))
        assert x_c.tobytes() == x_i.tobytes(), (k, np.flatnonzero(x_c != x_i))
        rows[k] = y_i
    assert p.tobytes() == block.parameters.tobytes()
    del keep
    return rows


def run(block: Block, inputs: Array) -> Array:
    """Outputs (k, n_y) of the interpreted block."""
    p, x, y = block.parameters.copy(), block.state.copy(), np.zeros(len(block.outputs))
    rows = np.empty((len(inputs), len(block.outputs)))
    for k, u in enumerate(inputs):
        block.step(p, x, np.asarray(u, dtype=np.float64), y)
        rows[k] = y
    return rows
