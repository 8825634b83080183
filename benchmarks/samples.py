"""µs a sample of a block: its step called by address from compiled code, or interpreted."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from harness.compiler.calls import call_status
from harness.compiler.step import compile_step
from harness.system.block import Block

Array = NDArray[np.float64]


@njit(nogil=True)  # type: ignore[untyped-decorator]
def _run(step: int, at: Any, u: Any, y: Any, inputs: Any, outputs: Any) -> None:
    p, x, u_at, y_at, sizes = at[0], at[1], at[2], at[3], at[4]
    for k in range(inputs.shape[0]):
        u[:] = inputs[k]
        call_status(step, (p, x, u_at, y_at, sizes))
        outputs[k] = y


def compiled(block: Block, inputs: Array) -> tuple[Array, float]:
    """Outputs (rows, n_y) of a fresh block at `inputs` (rows, n_u), and µs a row."""
    made = compile_step(block)
    p, x = block.parameters.copy(), block.state.copy()
    u, y = np.zeros(len(block.inputs)), _start(block)
    at = np.array([one.ctypes.data for one in (p, x, u, y, made.sizes)])
    outputs = np.zeros((len(inputs), len(y)))
    _run(made.address, at, u, y, inputs[:0], outputs)
    began = time.thread_time()
    _run(made.address, at, u, y, inputs, outputs)
    return outputs, 1e6 * (time.thread_time() - began) / len(inputs)


def interpreted(block: Block, inputs: Array) -> tuple[Array, float]:
    """The same in plain Python."""
    p, x, y = block.parameters.copy(), block.state.copy(), _start(block)
    outputs = np.zeros((len(inputs), len(y)))
    began = time.thread_time()
    with np.errstate(all="ignore"):
        for k, u in enumerate(inputs):
            block.step(p, x, u, y)
            outputs[k] = y
    return outputs, 1e6 * (time.thread_time() - began) / len(inputs)


def _start(block: Block) -> Array:
    return np.array([signal.start for signal in block.outputs])
