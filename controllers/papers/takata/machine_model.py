"""The generator at an infinite bus as a controller sees it: section 6 of Takata et al.

States x = (x₁ = δ − δ_0, x₂ = dδ/dt), input u = ΔE_fd:

    f₁ = x₂
    f₂ = (P_in − D·x₂ − P_max·sin(x₁ + δ_0)·(1 + u + w))/M,    P_max = e_l·E_fd/X_e

The paper's F(t) of (12) is ∂f/∂x without the control, P_max·cos(x₁ + δ_0) in place of
P_max·cos(x₁ + δ_0)·(1 + u): `input_in_jacobian` says which of the two a filter gets. The paper has
no process noise; the noise here, w, is one of the field.

This module refuses to know a filter and a design.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array, Signal
from controllers.core.errors import require, require_finite, require_not_negative, require_positive
from controllers.kalman.estimator import Model

INERTIA, DAMPING, STRENGTH, POWER, REST = range(5)

STATES = (
    Signal("angle_deviation", "rad", "rotor angle, from where it rests without control"),
    Signal("speed", "rad/s", "rotor speed, from synchronous speed"),
)
INPUTS = (Signal("field_deviation", "1", "change of the field voltage, as a share of it"),)
NOISES = (Signal("field_noise", "1", "noise of the field voltage, as a share of it"),)


def machine_rate(p: Array, x: Array, u: Array, rate: Array) -> None:
    """f(x) + g(x)·u."""
    electrical = p[STRENGTH] * math.sin(x[0] + p[REST]) * (1.0 + u[0])
    rate[0] = x[1]
    rate[1] = (p[POWER] - p[DAMPING] * x[1] - electrical) / p[INERTIA]


def machine_jacobian(p: Array, x: Array, u: Array, A: Array) -> None:
    """∂(f + g·u)/∂x, shape (2·2,)."""
    A[0] = 0.0
    A[1] = 1.0
    A[2] = -p[STRENGTH] * math.cos(x[0] + p[REST]) * (1.0 + u[0]) / p[INERTIA]
    A[3] = -p[DAMPING] / p[INERTIA]


def drift_jacobian(p: Array, x: Array, u: Array, A: Array) -> None:
    """∂f/∂x, the paper's F(t)."""
    A[0] = 0.0
    A[1] = 1.0
    A[2] = -p[STRENGTH] * math.cos(x[0] + p[REST]) / p[INERTIA]
    A[3] = -p[DAMPING] / p[INERTIA]


def machine_noise(p: Array, x: Array, u: Array, G: Array) -> None:
    """∂/∂w, shape (2·1,)."""
    G[0] = 0.0
    G[1] = -p[STRENGTH] * math.sin(x[0] + p[REST]) / p[INERTIA]


@dataclass(frozen=True, kw_only=True)
class MachineParameters:
    """Parameters of section 6, per unit, with times in s and angles in rad.

    rest_angle         δ_0; left out, asin(P_in/P_max), where f(0) = 0
    input_in_jacobian  ∂(f + g·u)/∂x as the Jacobian, not the paper's ∂f/∂x
    """

    inertia: float = 0.06
    damping: float = 0.06
    nominal_field_voltage: float = 1.0
    bus_voltage: float = 1.0
    line_reactance: float = 1.0
    mechanical_power: float = 0.8
    rest_angle: float | None = None
    input_in_jacobian: bool = False

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        name = "MachineParameters"
        for field in ("inertia", "nominal_field_voltage", "bus_voltage", "line_reactance"):
            require_positive(f"{name}.{field}", getattr(self, field))
        require_not_negative(f"{name}.damping", self.damping)
        require_finite(f"{name}.mechanical_power", self.mechanical_power)
        if self.rest_angle is not None:
            require_finite(f"{name}.rest_angle", self.rest_angle)
            return
        legal = abs(self.mechanical_power) < self.strength
        expected = f"less than P_max = {self.strength:g}, which the machine can deliver at rest"
        require(legal, f"{name}.mechanical_power", expected, self.mechanical_power)

    @property
    def strength(self) -> float:
        """P_max."""
        return self.bus_voltage * self.nominal_field_voltage / self.line_reactance

    def model(self) -> Model:
        """The model for `controllers.kalman.estimator.Estimator` and for designs."""
        rest = self.rest_angle
        if rest is None:
            rest = math.asin(self.mechanical_power / self.strength)
        return Model(
            states=STATES,
            inputs=INPUTS,
            noises=NOISES,
            parameters=np.array(
                [self.inertia, self.damping, self.strength, self.mechanical_power, rest]
            ),
            rate=machine_rate,
            jacobian=machine_jacobian if self.input_in_jacobian else drift_jacobian,
            noise=machine_noise,
        )
