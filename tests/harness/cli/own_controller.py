"""A user's own controllers, for `build package.module:Class`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array, Block, Signal


def proportional_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """u = gain · (reference − measured)."""
    y[0] = p[0] * (u[0] - u[1])


@dataclass(frozen=True)
class Proportional:
    """A gain on the error."""

    gain: float = 1.0

    def block(self, sample_time: float) -> Block:
        """The block."""
        return Block(
            inputs=(Signal("reference"), Signal("measured")),
            outputs=(Signal("u"),),
            step=proportional_step,
            parameters=np.array([self.gain]),
        )


def on_off(time: float, error: float) -> float:
    """A plain Python controller."""
    return 1.0 if error > 0.0 else 0.0


def allocating_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Makes an array at each sample."""
    work = np.zeros(3)
    y[0] = work[0] + u[0]


class Allocating:
    """A controller whose step allocates."""

    def block(self, sample_time: float) -> Block:
        """The block."""
        return Block((Signal("error"),), (Signal("u"),), allocating_step)
