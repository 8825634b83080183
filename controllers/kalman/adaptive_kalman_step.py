"""The step of the adaptive Kalman filter, over flat arrays; `adaptive_kalman` says
what it does and lays the arrays out.

p = [head | model | Q | R | fuzzy structure | θ],
x = [x̂ | P | memory | inputs of the instant before | ring | score | ẑ | H | R | γ | work].

This module refuses to choose parameters.
"""

from __future__ import annotations

from controllers.core.block import Array
from controllers.fuzzy.inference import infer
from controllers.kalman.extended_kalman import predict, update
from controllers.kalman.gain_adaptation import (
    INNOVATION_DISTANCE,
    innovation_distance,
    scale_score,
    state_distance,
    window_mean,
)

# Head of the parameters: sizes, choices, places in p (AT_…) and in x (X_…).
N_X, N_Z, N_U, N_S, SHARE, SCALED, ADAPTED, WINDOW, DISTANCE, CONSISTENT, N_RULES = range(11)
AT_Q, AT_R, AT_FUZZY, AT_THETA = range(11, 15)
X_P, X_MEMORY, X_BEFORE, X_RING, X_SCORE, X_Z, X_H, X_R, X_GAMMA, X_WORK = range(15, 25)
N_HEAD = 25

STARTED, COUNT, PLACE, GAIN = range(4)
N_MEMORY = 4

# Outputs: x̂ (n), ν (m), this head, g·K (n·m), diagonal of P (n).
Y_SQUARED, Y_DISTANCE, Y_GAIN = range(3)
N_OUTPUTS = 3


def model_transition(
    p: Array, s: Array, x: Array, u: Array, following: Array, F: Array, work: Array
) -> None:
    """x one sample later into `following` (n,) and its Jacobian F (n·n,); bound by `bind`."""


def model_measurement(p: Array, s: Array, x: Array, z: Array, H: Array) -> None:
    """ẑ (m,) and its Jacobian H (m·n,); bound by `bind`."""


def advance(p: Array, x: Array, given: Array, s: Array, q_scale: float) -> None:
    """Prediction of x̂ and P. `work` is: held input, following, F, q·Q, and the model's own."""
    n = int(p[N_X])
    n_u = int(p[N_U])
    before = x[int(p[X_BEFORE]) : int(p[X_RING])]
    work = x[int(p[X_WORK]) :]
    held = work[:n_u]
    following = work[n_u : n_u + n]
    F = work[n_u + n : n_u + n + n * n]
    Q = work[n_u + n + n * n : n_u + n + 2 * n * n]
    rest = work[n_u + n + 2 * n * n :]
    for i in range(n_u):
        held[i] = p[SHARE] * given[i] + (1.0 - p[SHARE]) * before[i]
    model_transition(p[N_HEAD:], s, x[:n], held, following, F, rest)
    for i in range(n):
        x[i] = following[i]
    for i in range(n * n):
        Q[i] = q_scale * p[int(p[AT_Q]) + i]
    predict(n, x[int(p[X_P]) : int(p[X_MEMORY])], F, Q, rest)


def expect(p: Array, x: Array, s: Array, r_scale: float, measured: Array, nu: Array) -> None:
    """ẑ, H and r·R into x, innovation into `nu`."""
    m = int(p[N_Z])
    z = x[int(p[X_Z]) : int(p[X_H])]
    model_measurement(p[N_HEAD:], s, x[: int(p[N_X])], z, x[int(p[X_H]) : int(p[X_R])])
    for a in range(m):
        nu[a] = measured[a] - z[a]
    for a in range(m * m):
        x[int(p[X_R]) + a] = r_scale * p[int(p[AT_R]) + a]


def adapt(p: Array, x: Array, nu: Array) -> float:
    """D² of this instant into the window, g from the scaled mean (16), the score; returns D̄²."""
    n = int(p[N_X])
    m = int(p[N_Z])
    P = x[int(p[X_P]) : int(p[X_MEMORY])]
    H = x[int(p[X_H]) : int(p[X_R])]
    memory = x[int(p[X_MEMORY]) : int(p[X_BEFORE])]
    work = x[int(p[X_WORK]) :]
    if int(p[DISTANCE]) == INNOVATION_DISTANCE:
        squared = innovation_distance(n, m, P, H, x[int(p[X_R]) : int(p[X_GAMMA])], nu, work)
    else:
        squared = state_distance(n, m, P, H, nu, work)
    window = int(p[WINDOW])
    place = int(memory[PLACE])
    count = min(int(memory[COUNT]) + 1, window)
    ring = x[int(p[X_RING]) : int(p[X_SCORE])]
    distance = float(window_mean(ring, count, place, squared) / memory[GAIN])
    memory[COUNT] = count
    memory[PLACE] = (place + 1) % window
    rules = int(p[N_RULES])
    work[0] = distance
    infer(
        p[int(p[AT_FUZZY]) : int(p[AT_THETA])], p[int(p[AT_THETA]) :], work[:1],
        work[1 : 1 + rules], work[1 + rules : 1 + 2 * rules], work[1 + 2 * rules : 1 + 3 * rules],
        memory[GAIN : GAIN + 1],
    )  # fmt: skip
    scale_score(x[int(p[X_SCORE]) : int(p[X_Z])], memory[GAIN], p[CONSISTENT] > 0.0)
    return distance


def show(p: Array, x: Array, y: Array) -> None:
    """Estimate, gains and variances into the outputs; `update` left K in its work space."""
    n = int(p[N_X])
    m = int(p[N_Z])
    gain = x[int(p[X_MEMORY]) + GAIN]
    K = x[int(p[X_WORK]) + 2 * n * m : int(p[X_WORK]) + 3 * n * m]
    P = x[int(p[X_P]) : int(p[X_MEMORY])]
    at = n + m + N_OUTPUTS
    y[n + m + Y_GAIN] = gain
    for i in range(n):
        y[i] = x[i]
        y[at + n * m + i] = P[i * n + i]
    for i in range(n * m):
        y[at + i] = gain * K[i]


def adaptive_kalman_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Inputs: z (m), known inputs, scheduled parameters, then q and r where they are scaled."""
    n = int(p[N_X])
    m = int(p[N_Z])
    given = u[m : m + int(p[N_U])]
    s = u[m + int(p[N_U]) : m + int(p[N_U]) + int(p[N_S])]
    q_scale = 1.0
    r_scale = 1.0
    if p[SCALED] > 0.0:
        q_scale = u[len(u) - 2]
        r_scale = u[len(u) - 1]
    memory = x[int(p[X_MEMORY]) : int(p[X_BEFORE])]
    if memory[STARTED] > 0.0:
        advance(p, x, given, s, q_scale)
    memory[STARTED] = 1.0
    nu = y[n : n + m]
    expect(p, x, s, r_scale, u[:m], nu)
    y[n + m + Y_DISTANCE] = 0.0
    if p[ADAPTED] > 0.0:
        y[n + m + Y_DISTANCE] = adapt(p, x, nu)
    y[n + m + Y_SQUARED] = update(
        n, m, x[:n], x[int(p[X_P]) : int(p[X_MEMORY])], nu, x[int(p[X_H]) : int(p[X_R])],
        x[int(p[X_R]) : int(p[X_GAMMA])], x[int(p[X_SCORE]) : int(p[X_Z])],
        x[int(p[X_GAMMA]) : int(p[X_WORK])], x[int(p[X_WORK]) :],
    )  # fmt: skip
    for i in range(len(given)):
        x[int(p[X_BEFORE]) + i] = given[i]
    show(p, x, y)
