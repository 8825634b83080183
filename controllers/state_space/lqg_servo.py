"""LQG control of an integrating process with a lag, with an observer of its disturbance.

    dF/dt = k'·v + d,   dv/dt = (u − v)/τ,   dd/dt = white noise,   y = F + noise

F is what is controlled, v what is left of the control behind the lag, d whatever else moves F: a
load, a leak, a moving environment. At sample instant k, with the stationary Kalman gain L of the
model sampled exactly:

    x̂ = x̂⁻ + L·(y − F̂⁻)
    u = v* − K_1·(F̂ − r) − K_2·(v̂ − v*),   v* = −d̂/k'                    limited to [u_min, u_max]
    x̂⁻ = Φ·x̂ + Γ·u                                                        for the next instant

So d̂ takes the place of an integral, and does not wind up: the observer is told the limited u. K is
the discrete LQ gain for the deviation from (r, v*). `loop` is the controller as a linear system,
for margins. This module refuses to know a plant.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import linalg

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require, require_not_negative, require_positive
from controllers.core.limit import limit
from controllers.state_space.lq import discrete_lq

N = 3  # F, v, d
P_PHI, P_GAMMA, P_L, P_K, P_SLOPE, P_U_MIN, P_U_MAX = 0, 9, 12, 15, 17, 18, 19


def lqg_servo_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Inputs: reference, measured; state: the prediction x̂⁻."""
    innovation = u[1] - x[0]
    force = x[0] + p[P_L] * innovation
    behind = x[1] + p[P_L + 1] * innovation
    disturbance = x[2] + p[P_L + 2] * innovation
    rest = -disturbance / p[P_SLOPE]
    wanted = rest - p[P_K] * (force - u[0]) - p[P_K + 1] * (behind - rest)
    limited = limit(wanted, p[P_U_MIN], p[P_U_MAX])
    for i in range(N):
        x[i] = (
            p[P_PHI + i * N] * force
            + p[P_PHI + i * N + 1] * behind
            + p[P_PHI + i * N + 2] * disturbance
            + p[P_GAMMA + i] * limited
        )
    y[0] = limited
    y[1] = force
    y[2] = disturbance
    y[3] = innovation
    y[4] = 0.0
    if wanted > limited:
        y[4] = 1.0
    if wanted < limited:
        y[4] = -1.0


@dataclass(frozen=True, eq=False)
class LQGDesign:
    """Φ (3, 3) and Γ (3,) of the sampled model, the Kalman gain L (3,), and the LQ gain K (2,)."""

    Phi: Array
    Gamma: Array
    L: Array
    K: Array


@dataclass(frozen=True, kw_only=True)
class LQGServo:
    """LQG servo for an integrating process.

    slope             k', output per second and unit of control
    lag               τ [s]; a dead time is best counted in
    output_noise      what moves F besides, per √s
    disturbance_noise how fast d drifts: output per second, per √s
    measurement_noise standard deviation of y at a sample
    error_scale       the error that is worth a control of 1 in the LQ criterion
    u_min, u_max      limits of the control
    """

    slope: float
    lag: float
    output_noise: float
    disturbance_noise: float
    measurement_noise: float
    error_scale: float
    u_min: float = -math.inf
    u_max: float = math.inf
    measured_unit: str = "1"
    output_unit: str = "1"

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        for name in ("slope", "lag", "disturbance_noise", "measurement_noise", "error_scale"):
            require_positive(f"LQGServo.{name}", getattr(self, name))
        require_not_negative("LQGServo.output_noise", self.output_noise)
        require(self.u_min < self.u_max, "LQGServo.u_min, u_max", "u_min below",
                (self.u_min, self.u_max))  # fmt: skip

    @cached_property
    def model(self) -> tuple[Array, Array]:
        """A (3, 3) and B (3,) of the process with its disturbance."""
        A = np.array([[0.0, self.slope, 1.0], [0.0, -1.0 / self.lag, 0.0], [0.0, 0.0, 0.0]])
        return A, np.array([0.0, 1.0 / self.lag, 0.0])

    def design(self, sample_time: float) -> LQGDesign:
        """The gains for a sample time [s]: of the Kalman filter as the stationary solution of its
        Riccati equation, which is that of an LQ design for the transposed model."""
        require_positive("LQGServo: sample_time", sample_time)
        A, B = self.model
        held = linalg.expm(sample_time * np.block([[A, B[:, None]], [np.zeros((1, 4))]]))
        Phi, Gamma = held[:3, :3], held[:3, 3]
        noise = np.diag([self.output_noise**2, 0.0, self.disturbance_noise**2])
        van_loan = linalg.expm(sample_time * np.block([[-A, noise], [np.zeros((3, 3)), A.T]]))
        Q = Phi @ van_loan[:3, 3:]
        C = np.array([[1.0, 0.0, 0.0]])
        R = np.array([[self.measurement_noise**2]])
        P = linalg.solve_discrete_are(Phi.T, C.T, 0.5 * (Q + Q.T), R)
        L = P[:, 0] / (P[0, 0] + R[0, 0])
        weights = np.diag([1.0 / self.error_scale**2, 0.0])
        lq = discrete_lq(Phi[:2, :2], Gamma[:2, None], weights, np.eye(1))
        return LQGDesign(Phi, Gamma, L, lq.K[0])

    def loop(self, sample_time: float) -> tuple[Array, Array, Array, float]:
        """A (3, 3), B (3,), C (3,), D of the controller from −y to u, unlimited, at r = 0."""
        d = self.design(sample_time)
        feedback = np.array([d.K[0], d.K[1], (1.0 + d.K[1]) / self.slope])  # u = −feedback·x̂
        corrected = np.eye(3) - np.outer(d.L, [1.0, 0.0, 0.0])
        closed = d.Phi - np.outer(d.Gamma, feedback)
        return closed @ corrected, -closed @ d.L, -feedback @ corrected, float(feedback @ d.L)

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        d = self.design(sample_time)
        parts = (d.Phi.ravel(), d.Gamma, d.L, d.K, [self.slope, self.u_min, self.u_max])
        return Block(
            inputs=(
                Signal("reference", self.measured_unit, "set point"),
                Signal("measured", self.measured_unit, "measured output"),
            ),
            outputs=(
                Signal("u", self.output_unit, "control, limited"),
                Signal("estimate", self.measured_unit, "estimated output"),
                Signal("disturbance", "", "estimated disturbance, output per second"),
                Signal("innovation", self.measured_unit, "measured − predicted"),
                Signal("saturated", "1", "1 at the upper limit, −1 at the lower, else 0"),
            ),
            step=lqg_servo_step,
            parameters=np.concatenate([np.asarray(part, dtype=np.float64) for part in parts]),
            state=np.zeros(N),
            state_names=("predicted_output", "predicted_lagged_control", "predicted_disturbance"),
        )
