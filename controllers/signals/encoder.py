"""Speed from an incremental encoder: the counts of a sample divided by the sample.

    ω_k = (θ_k − θ_{k−1})/(T·Ω_b)

θ is what the encoder counts; its quantisation stands on the wire that brings it. One count in a
sample is the resolution of the speed, 2π/(counts·T·Ω_b), and the errors of neighbouring samples
are opposite: the quantisation of the angle, differenced.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require_finite, require_positive

_SCALE = 0
_STARTED, _ANGLE = range(2)


def encoder_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Input: angle; output: mean speed since the sample before, 0 at the first."""
    y[0] = 0.0
    if x[_STARTED] > 0.0:
        y[0] = (u[0] - x[_ANGLE]) * p[_SCALE]
    x[_STARTED] = 1.0
    x[_ANGLE] = u[0]


@dataclass(frozen=True, kw_only=True)
class EncoderSpeed:
    """Speed in units of `base_speed` [rad/s] from an angle in rad."""

    base_speed: float = 1.0

    def __post_init__(self) -> None:
        """Raise `ControllerError` for a base speed that cannot be meant."""
        require_finite("EncoderSpeed.base_speed", self.base_speed)
        require_positive("EncoderSpeed.base_speed", self.base_speed)

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        require_positive("EncoderSpeed.block: sample_time", sample_time)
        return Block(
            inputs=(Signal("angle", "rad", "angle that the encoder has counted"),),
            outputs=(Signal("speed", "1", "mean speed since the sample before"),),
            step=encoder_step,
            parameters=np.array([1.0 / (sample_time * self.base_speed)]),
            parameter_names=("scale",),
            state=np.zeros(2),
            state_names=("started", "angle"),
        )
