"""The step of `estimator.Estimator`, and how its arrays are laid out.

`advance`, `measurement` and `measurement_jacobian` are placeholders (`controllers.core.bind`). This
module refuses to know a model.
"""

from __future__ import annotations

import math

from controllers.core.block import Array
from controllers.kalman.extended_kalman import predict, update
from controllers.kalman.p_point import N_SCORE
from controllers.kalman.transition import held_noise, reset_derivatives, transition_size

# Parameters: sizes and times, then q, extra, R, score, those of the model and of the measurement.
P_N, P_NU, P_NW, P_M, P_NP, P_STAGES, P_SUBSTEPS, P_T, P_PAST_INPUT, P_GIVEN_START, P_Q = range(11)
# State: whether the block has run, then u, X, P, Q, h, H, ν, γ and work space.
X_STARTED, X_U = 0, 1


def advance(
    n: int, n_w: int, stages: int, substeps: int, T: float, p: Array, u: Array, X: Array,
    work: Array,
) -> None:  # fmt: skip
    """Placeholder: `transition.integrate` or `transition.apply_map`, bound to a model."""


def measurement(p: Array, x: Array, u: Array, h: Array) -> None:
    """Placeholder: h(x, u) into `h` (m,); u is the input in force when z is read."""


def measurement_jacobian(p: Array, x: Array, u: Array, H: Array) -> None:
    """Placeholder: ∂h/∂x into `H` (m·n), row-major, every element."""


def estimator_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `Estimator`: inputs of the model, measurements, and the start where it is given."""
    n, n_u, n_w, m = int(p[P_N]), int(p[P_NU]), int(p[P_NW]), int(p[P_M])
    at_extra = P_Q + n_w
    at_r = at_extra + n
    at_score = at_r + m * m
    at_model = at_score + N_SCORE
    model = p[at_model : at_model + int(p[P_NP])]
    sensor = p[at_model + int(p[P_NP]) :]
    at_x = X_U + n_u
    at_p = at_x + transition_size(n, n_w)
    at_h = at_p + 2 * n * n
    at_nu = at_h + m + m * n
    held = x[X_U:at_x]
    X = x[at_x:at_p]
    P = x[at_p : at_p + n * n]
    h = x[at_h : at_h + m]
    H = x[at_h + m : at_nu]
    nu = x[at_nu : at_nu + m]
    gamma = x[at_nu + m : at_nu + 2 * m]
    work = x[at_nu + 2 * m :]
    if p[P_PAST_INPUT] > 0.0:
        for j in range(n_u):
            held[j] = u[j]
    if x[X_STARTED] > 0.0:
        Q = x[at_p + n * n : at_h]
        reset_derivatives(n, n_w, X)
        advance(n, n_w, int(p[P_STAGES]), int(p[P_SUBSTEPS]), p[P_T], model, held, X, work)
        held_noise(n, n_w, p[P_Q:at_extra], p[at_extra:at_r], X, Q)
        predict(n, P, X[n : n + n * n], Q, work)
    elif p[P_GIVEN_START] > 0.0:
        for i in range(n):
            X[i] = u[n_u + m + i]
    x[X_STARTED] = 1.0
    measurement(sensor, X[:n], held, h)
    measurement_jacobian(sensor, X[:n], held, H)
    for a in range(m):
        nu[a] = u[n_u + a] - h[a]
    R = p[at_r:at_score]
    squared = update(n, m, X[:n], P, nu, H, R, p[at_score:at_model], gamma, work)
    for j in range(n_u):
        held[j] = u[j]
    show_estimate(n, m, X, P, nu, squared, work, y)


def show_estimate(
    n: int, m: int, X: Array, P: Array, nu: Array, squared: float, work: Array, y: Array
) -> None:
    """Estimate, its deviations, innovation and its deviation, νᵀS⁻¹ν and gain, into y."""
    nm = n * m
    K = work[2 * nm : 3 * nm]
    L = work[3 * nm : 3 * nm + m * m]
    for i in range(n):
        y[i] = X[i]
        y[n + i] = math.sqrt(max(P[i * n + i], 0.0))
    for a in range(m):
        total = 0.0
        for b in range(a + 1):
            total = total + L[a * m + b] * L[a * m + b]
        y[2 * n + a] = nu[a]
        y[2 * n + m + a] = math.sqrt(total)
    y[2 * n + 2 * m] = squared
    for i in range(nm):
        y[2 * n + 2 * m + 1 + i] = K[i]
