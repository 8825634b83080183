"""Runs a block over readings, interpreted or compiled by numba, for the tests."""

import types

import numba
import numpy as np

from harness.system.block import KernelBlock, StepFunction


def compiled(function: StepFunction) -> StepFunction:
    """`function` compiled, with the plain functions that it names compiled too."""
    names = dict(function.__globals__)
    for name in function.__code__.co_names:
        if isinstance(names.get(name), types.FunctionType):
            names[name] = compiled(names[name])
    clone = types.FunctionType(function.__code__, names, function.__name__)
    return numba.njit(error_model="numpy")(clone)  # type: ignore[no-any-return]


def run(
    block: KernelBlock,
    readings: np.ndarray,
    added: np.ndarray | None = None,
    step: StepFunction | None = None,
) -> np.ndarray:
    """What the reader gets, shape (n,); the block's own arrays stay as they were."""
    step = step or block.step
    p, x = block.parameters.copy(), block.state.copy()
    u, y = np.zeros(len(block.inputs)), np.zeros(1)
    got = np.empty(len(readings))
    for k, reading in enumerate(readings):
        u[0] = reading
        if added is not None:
            u[1] = added[k]
        step(p, x, u, y)
        got[k] = y[0]
    assert np.array_equal(p, block.parameters), "parameters are read only"
    return got
