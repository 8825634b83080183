"""The electro-hydraulic servo as an estimator sees it: (7), (8) and (14) of Raheem 2013.

States x = (position x₁, speed x₂, load pressure x₃, spool position x₄), input the current i:

    f₁ = x₂
    f₂ = a₂₁x₁ + a₂₂x₂ + a₂₃x₃ − ΔF_L/m          a₂₁ = −k/m, a₂₂ = −F/m, a₂₃ = A/m
    f₃ = a₃₂x₂ + a₃₃x₃ + a₃₄x₄·r(P_s − s·x₃)     a₃₂ = −4βA/V, a₃₃ = −4βC_tp/V,
                                                 a₃₄ = 4βC_d·w/(V√ρ)
    f₄ = a₄₄x₄ + b(i + Δi)                       a₄₄ = −1/τ_v, b = K/τ_v

with s = x₄/√(x₄² + δ²) for sgn(x₄) and r(z) = z/(z² + ε²)^¼ for √z. a₂₂ and a₂₃, a₄₄, and the
row of ΔF_L stand here as they follow from (1) and (5), not as they are printed. Away from the
widths δ and ε the Jacobian has

    ∂f₃/∂x₃ = a₃₃ − a₃₄|x₄|/(2√(P_s − sgn(x₄)x₃)),    ∂f₃/∂x₄ = a₃₄√(P_s − sgn(x₄)x₃).

The noise is w = (Δi, ΔF_L). This module refuses to know a filter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array, Signal
from controllers.core.errors import require, require_not_negative, require_positive
from controllers.kalman.estimator import Measurement, Model
from controllers.kalman.linear_model import linear_model

A21, A22, A23, A32, A33, A34, A44, B_CURRENT, B_FORCE, PS, SIGN_WIDTH, ROOT_WIDTH = range(12)

STATES = (
    Signal("position", "m", "load displacement"),
    Signal("velocity", "m/s", "load speed"),
    Signal("load_pressure", "Pa", "pressure difference across the piston"),
    Signal("spool_position", "m", "spool displacement"),
)
INPUTS = (Signal("current", "A", "commanded current"),)
NOISES = (Signal("current_error", "A", "Δi"), Signal("load_force", "N", "ΔF_L"))
POSITION = Signal("measured", "m", "what the position sensor reads")
SPEED = Signal("measured", "m/s", "what the speed sensor reads")


def servo_rate(p: Array, x: Array, u: Array, rate: Array) -> None:
    """f of (8)."""
    sign = x[3] / math.sqrt(x[3] * x[3] + p[SIGN_WIDTH] * p[SIGN_WIDTH])
    z = p[PS] - sign * x[2]
    root = z / math.sqrt(math.sqrt(z * z + p[ROOT_WIDTH] * p[ROOT_WIDTH]))
    rate[0] = x[1]
    rate[1] = p[A21] * x[0] + p[A22] * x[1] + p[A23] * x[2]
    rate[2] = p[A32] * x[1] + p[A33] * x[2] + p[A34] * x[3] * root
    rate[3] = p[A44] * x[3] + p[B_CURRENT] * u[0]


def servo_jacobian(p: Array, x: Array, u: Array, A: Array) -> None:
    """∂f/∂x of (14), shape (4·4,)."""
    for i in range(16):
        A[i] = 0.0
    spread = x[3] * x[3] + p[SIGN_WIDTH] * p[SIGN_WIDTH]
    sign = x[3] / math.sqrt(spread)
    turn = p[SIGN_WIDTH] * p[SIGN_WIDTH] / (spread * math.sqrt(spread))
    z = p[PS] - sign * x[2]
    softened = z * z + p[ROOT_WIDTH] * p[ROOT_WIDTH]
    fourth = math.sqrt(math.sqrt(softened))
    root = z / fourth
    slope = (0.5 * z * z + p[ROOT_WIDTH] * p[ROOT_WIDTH]) / (softened * fourth)
    A[1] = 1.0
    A[4] = p[A21]
    A[5] = p[A22]
    A[6] = p[A23]
    A[9] = p[A32]
    A[10] = p[A33] - p[A34] * x[3] * sign * slope
    A[11] = p[A34] * (root - x[3] * slope * turn * x[2])
    A[15] = p[A44]


def servo_noise(p: Array, x: Array, u: Array, G: Array) -> None:
    """∂f/∂w of (10), shape (4·2,): Δi moves the spool, ΔF_L slows the load."""
    for i in range(8):
        G[i] = 0.0
    G[3] = p[B_FORCE]
    G[6] = p[B_CURRENT]


def position_output(p: Array, x: Array, u: Array, h: Array) -> None:
    """h of Fig. 1: the position."""
    h[0] = x[0]


def position_jacobian(p: Array, x: Array, u: Array, H: Array) -> None:
    """C_k as printed: (1, 0, 0, 0)."""
    for i in range(4):
        H[i] = 0.0
    H[0] = 1.0


def speed_output(p: Array, x: Array, u: Array, h: Array) -> None:
    """h of (6) and (9): the speed."""
    h[0] = x[1]


def speed_jacobian(p: Array, x: Array, u: Array, H: Array) -> None:
    """(0, 1, 0, 0)."""
    for i in range(4):
        H[i] = 0.0
    H[1] = 1.0


def no_output(p: Array, x: Array, u: Array, h: Array) -> None:
    """Nothing is measured."""


def no_jacobian(p: Array, x: Array, u: Array, H: Array) -> None:
    """Nothing is measured."""


@dataclass(frozen=True, kw_only=True)
class ServoParameters:
    """Physical parameters in SI units: Table 1, and choices for what it lacks (see the plant)."""

    load_mass: float = 24.0
    spring_stiffness: float = 16010.0
    friction: float = 60.0
    piston_area: float = 3.2673e-4
    total_volume: float = 6.535e-5
    bulk_modulus: float = 1e9
    leakage: float = 2e-12
    discharge_coefficient: float = 0.6
    spool_gradient: float = 0.022
    oil_density: float = 840.0
    supply_pressure: float = 10342500.0
    valve_time_constant: float = 0.01
    valve_gain: float = 4.5e-3
    spool_sign_width: float = 1e-7
    orifice_root_width: float = 1e4

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        for name, value in vars(self).items():
            may_vanish = name in ("spring_stiffness", "friction", "leakage", "valve_gain")
            check = require_not_negative if may_vanish else require_positive
            check(f"ServoParameters.{name}", value)

    def coefficients(self) -> Array:
        """The coefficients of (8) in the order of A21 … ROOT_WIDTH."""
        q = self
        stiffness = 4.0 * q.bulk_modulus / q.total_volume
        flow = q.discharge_coefficient * q.spool_gradient / math.sqrt(q.oil_density)
        return np.array(
            [
                -q.spring_stiffness / q.load_mass,
                -q.friction / q.load_mass,
                q.piston_area / q.load_mass,
                -stiffness * q.piston_area,
                -stiffness * q.leakage,
                stiffness * flow,
                -1.0 / q.valve_time_constant,
                q.valve_gain / q.valve_time_constant,
                -1.0 / q.load_mass,
                q.supply_pressure,
                q.spool_sign_width,
                q.orifice_root_width,
            ]
        )

    def model(self) -> Model:
        """The model for `controllers.kalman.estimator.Estimator`."""
        return Model(
            states=STATES,
            inputs=INPUTS,
            noises=NOISES,
            parameters=self.coefficients(),
            rate=servo_rate,
            jacobian=servo_jacobian,
            noise=servo_noise,
        )

    def linear(self) -> Model:
        """The model linearised at rest, valve closed: for a Kalman filter that is not extended."""
        p, x, u = self.coefficients(), np.zeros(4), np.zeros(1)
        A, G, B = np.zeros(16), np.zeros(8), np.zeros((4, 1))
        servo_jacobian(p, x, u, A)
        servo_noise(p, x, u, G)
        B[3, 0] = p[B_CURRENT]
        return linear_model(STATES, INPUTS, NOISES, A.reshape(4, 4), B, G.reshape(4, 2))


def servo_measurement(kind: str, std: float) -> Measurement:
    """ "speed" (6), "position" (Fig. 1) or "none", with noise of standard deviation `std`."""
    kinds = {
        "speed": ((SPEED,), speed_output, speed_jacobian),
        "position": ((POSITION,), position_output, position_jacobian),
        "none": ((), no_output, no_jacobian),
    }
    require(kind in kinds, "servo_measurement", "one of " + ", ".join(kinds), kind)
    signals, output, jacobian = kinds[kind]
    m = len(signals)
    return Measurement(signals=signals, output=output, jacobian=jacobian, R=std**2 * np.eye(m))
