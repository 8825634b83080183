"""The benchmark plant of Narendra & Parthasarathy (1990) as a block in the loop.

    y_{k+1} = y_k·y_{k−1}·(y_k + 2.5)/(1 + y_k² + y_{k−1}²) + u_k

It is a difference equation without a continuous counterpart, so it is a block and not an FMU:
the plants of this project are ordinary differential equations. Its output at instant k does not
depend on u_k, so it may stand in a loop like an FMU. ∂y_{k+1}/∂u_k = 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require, require_finite

Y, Y_BEFORE = 0, 1


def narendra_parthasarathy_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y_k out, then the state on to instant k + 1 with u_k."""
    now = x[Y]
    before = x[Y_BEFORE]
    y[0] = now
    x[Y] = now * before * (now + 2.5) / (1.0 + now * now + before * before) + u[0]
    x[Y_BEFORE] = now


@dataclass(frozen=True, kw_only=True)
class NarendraParthasarathy:
    """The benchmark plant; `start` is (y_0, y_{−1})."""

    start: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        """Raise `ControllerError` unless `start` is a pair of numbers."""
        require(len(self.start) == 2, "NarendraParthasarathy.start", "a pair", self.start)
        for value in self.start:
            require_finite("NarendraParthasarathy.start", value)

    def block(self, sample_time: float) -> Block:
        """The block; the sample time does not matter."""
        return Block(
            inputs=(Signal("u", "1", "input u_k"),),
            outputs=(Signal("y", "1", "output y_k", start=self.start[0]),),
            step=narendra_parthasarathy_step,
            state=np.array(self.start, dtype=np.float64),
            state_names=("y", "y_before"),
        )
