"""The delay line: a value leaves `depth` executions after it came in.

It runs before everything else at its instant, so that with depth 0 it passes on what was held
until then; that is how a delay of one sample comes about without a memory of its own. What it
gives before the first value arrives is filled in when a run is initialised: the initial value of
its source.
"""

from __future__ import annotations

import numpy as np

from harness.system.block import Array, KernelBlock, Port


def delay_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """p = (depth,), x = (next place, ring of `depth` values)."""
    depth = int(p[0])
    if depth == 0:
        y[0] = u[0]
    else:
        place = int(x[0])
        y[0] = x[1 + place]
        x[1 + place] = u[0]
        x[0] = float((place + 1) % depth)


def delay_block(depth: int) -> KernelBlock:
    """A delay of `depth` executions."""
    return KernelBlock(
        inputs=(Port("in"),),
        outputs=(Port("out"),),
        step=delay_step,
        parameters=np.array([float(depth)]),
        state=np.zeros(1 + depth),
    )
