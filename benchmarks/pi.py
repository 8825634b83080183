"""The PI controller of the benchmarks, once as a block and once as plain Python.

    e = r - y,   I += ki e,   u = kp e + I

with ki the integral gain per sample. The bare C program does the same operations in the same
order, so that all sides reach the same bits.
"""

from __future__ import annotations

import numpy as np

from harness.system.block import Array, KernelBlock, Port

STEP = 0.01
REFERENCE, KP, KI = 1.0, 0.5, 0.005


def pi_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """p = (r, kp, ki), x = (integral,), u = (y,), y = (u,)."""
    error = p[0] - u[0]
    x[0] += p[2] * error
    y[0] = p[1] * error + x[0]


def pi_block() -> KernelBlock:
    """The controller for the compiled loop."""
    return KernelBlock(
        (Port("y"),), (Port("u"),), pi_step, np.array([REFERENCE, KP, KI]), np.zeros(1)
    )


class PlainPI:
    """The controller as plain Python, with a method `step(time, y)`."""

    def __init__(self) -> None:
        """At rest."""
        self.integral = 0.0

    def step(self, time: float, y: float) -> float:
        """The control at `time`."""
        error = REFERENCE - y
        self.integral += KI * error
        return KP * error + self.integral
