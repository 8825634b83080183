"""The step of `estimator.Estimator`, and how its arrays are laid out.

`advance`, `measurement` and `measurement_jacobian` are placeholders (`controllers.core.bind`). This
module refuses to know a model.
"""

from __future__ import annotations

import math

from controllers.core.block import Array
from controllers.core.layout import Layout, part
from controllers.kalman.extended_kalman import predict, update
from controllers.kalman.p_point import N_SCORE
from controllers.kalman.transition import held_noise, reset_derivatives

STATE = Layout.of(
    started=(), held="inputs", X="transition", P=("states", "states"), Q=("states", "states"),
    h="measured", H=("measured", "states"), nu="measured", gamma="measured", work="work",
)  # fmt: skip
_, HELD, X_, P_, Q_, H_, JACOBIAN, NU, GAMMA, WORK = map(STATE.number, STATE.names)
X_STARTED = STATE.place("started")

# Parameters: `HEAD`, then `MATRICES`.
MATRICES = Layout.of(
    q="noises", extra="states", R=("measured", "measured"), score=N_SCORE, model="model",
    sensor="sensor",
)  # fmt: skip
NOISE, EXTRA, R_, SCORE, MODEL, SENSOR = map(MATRICES.number, MATRICES.names)
HEAD = Layout.of(
    n=(), n_u=(), n_w=(), m=(), stages=(), substeps=(), T=(), past_input=(), given_start=(),
    in_parameters=MATRICES.entries, in_state=STATE.entries,
)  # fmt: skip
(P_N, P_NU, P_NW, P_M, P_STAGES, P_SUBSTEPS, P_T, P_PAST_INPUT, P_GIVEN_START, P_IN_PARAMETERS,
 P_IN_STATE) = HEAD.places()  # fmt: skip


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
    in_p, in_x = p[P_IN_PARAMETERS:], p[P_IN_STATE:]
    held, X, P = part(in_x, x, HELD), part(in_x, x, X_), part(in_x, x, P_)
    h, H = part(in_x, x, H_), part(in_x, x, JACOBIAN)
    nu, work = part(in_x, x, NU), part(in_x, x, WORK)
    sensor = part(in_p, p, SENSOR)
    if p[P_PAST_INPUT] > 0.0:
        for j in range(n_u):
            held[j] = u[j]
    if x[X_STARTED] > 0.0:
        Q = part(in_x, x, Q_)
        model = part(in_p, p, MODEL)
        reset_derivatives(n, n_w, X)
        advance(n, n_w, int(p[P_STAGES]), int(p[P_SUBSTEPS]), p[P_T], model, held, X, work)
        held_noise(n, n_w, part(in_p, p, NOISE), part(in_p, p, EXTRA), X, Q)
        predict(n, P, X[n : n + n * n], Q, work)
    elif p[P_GIVEN_START] > 0.0:
        for i in range(n):
            X[i] = u[n_u + m + i]
    x[X_STARTED] = 1.0
    measurement(sensor, X[:n], held, h)
    measurement_jacobian(sensor, X[:n], held, H)
    for a in range(m):
        nu[a] = u[n_u + a] - h[a]
    R, score, gamma = part(in_p, p, R_), part(in_p, p, SCORE), part(in_x, x, GAMMA)
    squared = update(n, m, X[:n], P, nu, H, R, score, gamma, work)
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
