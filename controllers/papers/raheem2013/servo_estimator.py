"""The extended Kalman filter of the electro-hydraulic servo, with the settings a user has.

The filter is `estimator.Estimator` on `servo_model`; this module only turns named numbers into
its arrays. It reads the commanded current and one sensor, and estimates position, speed, load
pressure and spool position. The paper gives no noise, Q, R, x_0 and P_0: those are fields.

This module refuses to know the plant: `model` says what the filter believes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields

import numpy as np

from controllers.core.block import Block
from controllers.core.errors import require, require_finite, require_not_negative, require_positive
from controllers.kalman.estimator import Estimator
from controllers.kalman.p_point import PPoint, gaussian_score
from controllers.papers.raheem2013.servo_model import STATES, ServoParameters, servo_measurement

Four = tuple[float, float, float, float]


@dataclass(frozen=True, kw_only=True)
class ServoEstimator:
    """Extended Kalman filter for the servo.

    measured        "speed", "position", or "none" for a simulation of the model alone
    sensor_std      standard deviation of the measurement noise [m/s or m]
    current_std     of Δi [A]
    force_std       of ΔF_L [N]
    noise_interval  how long these two are held, at most a sample; left out, a sample [s]. Noise
                    that changes within the sample counts with its mean over the sample.
    extra_std       of noise added to (x₁, x₂, x₃, x₄) at each sample [m, m/s, Pa, m], for what
                    the model does not know
    inflation       factor on all of Q
    initial         estimate before the first measurement [m, m/s, Pa, m]
    initial_std     its standard deviation
    discretisation  "runge_kutta" or "euler"
    substeps        steps of it in a sample
    linear          believe the model linearised at rest: a Kalman filter that is not extended
    robust          mass p of the p-point score, or none for the plain filter
    model           physical parameters that the filter believes, where they are not Table 1's
    """

    measured: str = "speed"
    sensor_std: float
    current_std: float
    force_std: float
    noise_interval: float | None = None
    extra_std: Four = (0.0, 0.0, 0.0, 0.0)
    inflation: float = 1.0
    initial: Four = (0.0, 0.0, 0.0, 0.0)
    initial_std: Four = (0.0, 0.0, 0.0, 0.0)
    discretisation: str = "runge_kutta"
    substeps: int = 1
    linear: bool = False
    robust: float | None = None
    model: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        require_positive("ServoEstimator.sensor_std", self.sensor_std)
        for name in ("current_std", "force_std", "inflation"):
            require_not_negative(f"ServoEstimator.{name}", getattr(self, name))
        for name in ("extra_std", "initial", "initial_std"):
            values = getattr(self, name)
            require(len(values) == len(STATES), f"ServoEstimator.{name}", "four numbers", values)
            check = require_finite if name == "initial" else require_not_negative
            for value in values:
                check(f"ServoEstimator.{name}", value)
        known = [f.name for f in fields(ServoParameters)]
        for name in self.model:
            require(name in known, "ServoEstimator.model", "one of " + ", ".join(known), name)
        if self.noise_interval is not None:
            require_positive("ServoEstimator.noise_interval", self.noise_interval)
        self.estimator(math.inf if self.noise_interval is None else self.noise_interval)

    def estimator(self, sample_time: float) -> Estimator:
        """The general filter with these numbers for this sample time [s]."""
        held = sample_time if self.noise_interval is None else self.noise_interval
        fits = held <= sample_time * (1.0 + 1e-9)
        expected = f"at most the sample time {sample_time:g} s"
        require(fits, "ServoEstimator.noise_interval", expected, held)
        share = 1.0 if self.noise_interval is None else held / sample_time
        noise = np.array([self.current_std, self.force_std])
        parameters = ServoParameters(**self.model)
        return Estimator(
            model=parameters.linear() if self.linear else parameters.model(),
            measurement=servo_measurement(self.measured, self.sensor_std),
            q=self.inflation * share * noise**2,
            extra=self.inflation * np.array(self.extra_std) ** 2,
            x_0=np.array(self.initial, dtype=np.float64),
            P_0=np.diag(np.array(self.initial_std, dtype=np.float64) ** 2),
            discretisation=self.discretisation,
            substeps=self.substeps,
            score=gaussian_score() if self.robust is None else PPoint(self.robust).score(),
        )

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        return self.estimator(sample_time).block(sample_time)
