"""The continuous-time filter (11), (15), (16) of Takata et al., run at sample instants.

    dx̂/dt = f(x̂) + g(x̂)·u + K(t)·(y − H·x̂),   K = S·Hᵀ·V⁻¹                           (11), (15)
    dS/dt = F·S + S·Fᵀ − S·Hᵀ·V⁻¹·H·S (+ G·q·Gᵀ),   S(0) = S_0                             (16)

Explicit Euler on (16) diverges where H·S·Hᵀ·T/V is large, as it is while S_0 is. Here instead the
measurement at an instant counts as the white noise of intensity V, averaged over the sample time
T, has it: a discrete update with R = V/T. Between instants x̂ follows f + g·u, u held, by
Runge–Kutta, and S ← Φ·S·Φᵀ (+ Γ·q/T·Γᵀ) with Φ the exact derivative of that step. This

- is what `estimator.Estimator` does, so S stays symmetric and positive semidefinite for every T;
- is the optimal filter of a linear model that is sampled with noise of variance V/T;
- tends to (11), (15) and (16) as T → 0, with an error of order T.

`linear` believes the model linearised at rest, f(0) = 0: a Kalman filter that is not extended.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from controllers.core.block import Block
from controllers.core.errors import require, require_positive
from controllers.kalman.estimator import Estimator, Model
from controllers.kalman.p_point import PPoint, gaussian_score
from controllers.state_space.affine_model import find_model, linearised, measure_states
from controllers.state_space.state_weights import Weights, weight_matrix


@dataclass(frozen=True, kw_only=True)
class KalmanBucy:
    """The filter of a model by name, for a loop whose control is computed of its estimate.

    model            a model, or "package.module:Class"; `model_parameters` go to that class
    measured         names of the states that are measured
    noise_intensity  V of each, or a matrix [unit²·s]
    process_noise    intensities q of the model's noises [unit²·s]; left out, none
    start            x̂(0);  given_start: it comes through inputs `initial_…` instead
    covariance       S(0): diagonal or matrix
    linear           believe the linear model at rest
    robust           mass p of the p-point score, or none for the plain filter
    substeps         Runge–Kutta steps in a sample

    Inputs: the model's inputs **as they were until this instant** (the control, delayed by one
    sample), then `measured_…`. The first outputs are the estimates, by the names of the states.
    """

    model: str | Model
    model_parameters: Mapping[str, Any] = field(default_factory=dict)
    measured: tuple[str, ...]
    noise_intensity: Weights
    process_noise: tuple[float, ...] = ()
    start: tuple[float, ...]
    given_start: bool = False
    covariance: Weights
    linear: bool = False
    robust: float | None = None
    substeps: int = 1

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        self.estimator(1.0)

    def estimator(self, sample_time: float) -> Estimator:
        """The discrete filter for this sample time [s]."""
        require_positive("KalmanBucy: sample_time", sample_time)
        model = find_model(self.model, self.model_parameters)
        if self.linear:
            model = linearised(model)
        n, n_w, m = len(model.states), len(model.noises), len(self.measured)
        V = weight_matrix("KalmanBucy.noise_intensity", self.noise_intensity, m)
        lowest = float(np.min(np.linalg.eigvalsh(V), initial=np.inf))
        require(lowest > 0.0, "KalmanBucy.noise_intensity", "eigenvalues greater than 0", lowest)
        q = np.array(self.process_noise or (0.0,) * n_w, dtype=np.float64)
        return Estimator(
            model=model,
            measurement=measure_states(model, self.measured, V / sample_time),
            q=q / sample_time,
            x_0=np.array(self.start, dtype=np.float64),
            P_0=weight_matrix("KalmanBucy.covariance", self.covariance, n),
            substeps=self.substeps,
            score=gaussian_score() if self.robust is None else PPoint(self.robust).score(),
            input_interval="past",
            given_start=self.given_start,
        )

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        return self.estimator(sample_time).block(sample_time)
