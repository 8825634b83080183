"""The Kalman filter of the two-mass drive, with adapted gain and scheduled T_2.

Equations (10) and (13)–(16) of Serkies & Szabat 2013; the filter is that of
`controllers.kalman.adaptive_kalman`, the model `two_mass`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.core.block import Block, Signal
from controllers.core.errors import require, require_positive
from controllers.kalman.adaptive_kalman import KalmanModel, Noise, kalman_block
from controllers.kalman.gain_adaptation import GainAdaptation
from controllers.papers.serkies2013.two_mass import (
    TRANSITION_WORK,
    two_mass_measurement,
    two_mass_transition,
)


@dataclass(frozen=True, kw_only=True)
class TwoMassKalman:
    """Kalman filter of the two-mass drive: ω_1, ω_2, m_s, m_L from ω_1 and m_e.

    motor_time_constant   T_1 [s];  shaft_time_constant  T_c [s]
    q                     diagonal of Q: variances of ω_1, ω_2, m_s, m_L gained in a second [1/s]
    r                     variance of the measured speed
    initial_variance      diagonal of P_0
    input_delay           how late a torque reading acts, up to a sample [s]; None: at the sample
    distances, gains,     see `GainAdaptation`; no distances, no adaptation
    window, distance,
    covariance
    scaled_noise          inputs q_scale and r_scale, for `FuzzyInertiaEstimator`

    Inputs: motor_speed, electromagnetic_torque, load_time_constant (T_2 in force).
    """

    motor_time_constant: float
    shaft_time_constant: float
    q: tuple[float, ...]
    r: float
    initial_variance: tuple[float, ...] = (1e-4, 1e-4, 1e-2, 1e-2)
    input_delay: float | None = None
    distances: tuple[float, ...] = ()
    gains: tuple[float, ...] = ()
    window: int = 100
    distance: str = "state"
    covariance: str = "consistent"
    scaled_noise: bool = False

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        for name in ("motor_time_constant", "shaft_time_constant", "r"):
            require_positive(f"TwoMassKalman.{name}", getattr(self, name))
        for name in ("q", "initial_variance"):
            given = getattr(self, name)
            four = len(given) == 4 and all(value >= 0.0 for value in given)
            require(four, f"TwoMassKalman.{name}", "four numbers, none below 0", given)

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        require_positive("TwoMassKalman.block: sample_time", sample_time)
        delay = sample_time if self.input_delay is None else self.input_delay
        require(0.0 <= delay <= sample_time, "TwoMassKalman.input_delay",
                f"0 to the sample time {sample_time:g} s", delay)  # fmt: skip
        adaptation = None
        if self.distances or self.gains:
            adaptation = GainAdaptation(
                distances=self.distances, gains=self.gains, window=self.window,
                distance=self.distance, covariance=self.covariance,
            )  # fmt: skip
        noise = Noise(
            Q=np.diag(self.q) * sample_time,
            R=np.array([[self.r]]),
            P=np.diag(self.initial_variance),
            x=np.zeros(4),
        )
        return kalman_block(
            self.model(sample_time), noise, adaptation=adaptation,
            input_share=1.0 - delay / sample_time, scaled_noise=self.scaled_noise,
        )  # fmt: skip

    def model(self, sample_time: float) -> KalmanModel:
        """The drive as the filter takes it."""
        return KalmanModel(
            transition=two_mass_transition,
            measurement=two_mass_measurement,
            parameters=np.array([self.motor_time_constant, self.shaft_time_constant, sample_time]),
            work=TRANSITION_WORK,
            states=(
                Signal("estimated_motor_speed", "1", "ω_1"),
                Signal("estimated_load_speed", "1", "ω_2"),
                Signal("estimated_shaft_torque", "1", "m_s"),
                Signal("estimated_load_torque", "1", "m_L"),
            ),
            measured=(Signal("motor_speed", "1", "measured ω_1"),),
            inputs=(Signal("electromagnetic_torque", "1", "m_e"),),
            scheduled=(Signal("load_time_constant", "s", "T_2 in force", 1.0),),
        )
