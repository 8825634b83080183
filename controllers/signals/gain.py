"""A gain with an offset: y = gain·u + bias, without delay.

As a sensor it gives a signal with its imperfections one name, so that several blocks read the
same noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require_finite


def gain_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = gain·u + bias."""
    y[0] = p[0] * u[0] + p[1]


@dataclass(frozen=True, kw_only=True)
class Gain:
    """y = gain·u + bias; `gain` [output_unit/input_unit], `bias` [output_unit]."""

    gain: float = 1.0
    bias: float = 0.0
    input_unit: str = "1"
    output_unit: str = "1"

    def __post_init__(self) -> None:
        """Raise `ControllerError` unless gain and bias are finite."""
        require_finite("Gain.gain", self.gain)
        require_finite("Gain.bias", self.bias)

    def block(self, sample_time: float) -> Block:
        """The block; the sample time does not matter."""
        return Block(
            inputs=(Signal("u", self.input_unit, "input"),),
            outputs=(Signal("y", self.output_unit, "gain·u + bias"),),
            step=gain_step,
            parameters=np.array([self.gain, self.bias], dtype=np.float64),
            parameter_names=("gain", "bias"),
            tunable=("gain", "bias"),
        )
