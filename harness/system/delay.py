"""The delay line: a value leaves `depth` executions after it came in.

It runs before everything else at its instant, so that with depth 0 it passes on what was held
until then; that is how a delay of one sample comes about without a memory of its own. What it
gives before the first value arrives is filled in when a run is initialised: the initial value of
its source.
"""

from __future__ import annotations

import numpy as np

from harness.instruments.imperfection_steps import delay_step, pass_step
from harness.system.block import KernelBlock, Port


def delay_block(depth: int) -> KernelBlock:
    """A delay of `depth` executions; its state is the next place and a ring of `depth` values."""
    step = delay_step if depth else pass_step
    return KernelBlock((Port("in"),), (Port("out"),), step, state=np.zeros(1 + depth))
