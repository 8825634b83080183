"""The step of the adaptive Kalman filter, over flat arrays; `adaptive_kalman` says what it does.

Block arrays: p is `HEAD`, then `MATRICES`; x is `STATE`.

This module refuses to choose parameters.
"""

from __future__ import annotations

from controllers.core.block import Array
from controllers.core.layout import Layout, part
from controllers.fuzzy.inference import infer
from controllers.kalman.extended_kalman import predict, update
from controllers.kalman.gain_adaptation import (
    INNOVATION_DISTANCE,
    innovation_distance,
    scale_score,
    state_distance,
    window_mean,
)
from controllers.kalman.p_point import N_SCORE

# State: x̂, P, memory, the inputs and the window of D², what update works on.
MEMORY = Layout.of(started=(), count=(), place=(), gain=())
STARTED, COUNT, PLACE, GAIN = MEMORY.places()
STATE = Layout.of(
    x="states", P=("states", "states"), memory=MEMORY.length, before="inputs", ring="window",
    score=N_SCORE, z="measured", H=("measured", "states"), R=("measured", "measured"),
    gamma="measured", work="work",
)  # fmt: skip
X_, P_, MEMORY_, BEFORE, RING, SCORE, Z_, H_, R_, GAMMA, WORK = map(STATE.number, STATE.names)

MATRICES = Layout.of(
    model="model", Q=("states", "states"), R=("measured", "measured"), structure="structure",
    theta="theta",
)  # fmt: skip
MODEL, PROCESS, SENSOR, STRUCTURE, THETA = map(MATRICES.number, MATRICES.names)
HEAD = Layout.of(
    n=(), m=(), n_u=(), n_s=(), share=(), scaled=(), adapted=(), window=(), distance=(),
    consistent=(), rules=(), in_parameters=MATRICES.entries, in_state=STATE.entries,
)  # fmt: skip
(N_X, N_Z, N_U, N_S, SHARE, SCALED, ADAPTED, WINDOW, DISTANCE, CONSISTENT, N_RULES,
 IN_PARAMETERS, IN_STATE) = HEAD.places()  # fmt: skip

# Outputs: x̂ (n), ν (m), this head, g·K (n·m), diagonal of P (n).
Y_SQUARED, Y_DISTANCE, Y_GAIN = range(3)
N_OUTPUTS = 3


def model_transition(
    p: Array, s: Array, x: Array, u: Array, following: Array, F: Array, work: Array
) -> None:
    """x one sample later into `following` (n,) and its Jacobian F (n·n,); bound by `bind`."""


def model_measurement(p: Array, s: Array, x: Array, z: Array, H: Array) -> None:
    """ẑ (m,) and its Jacobian H (m·n,); bound by `bind`."""


def given(p: Array, which: int) -> Array:
    """A part of `MATRICES`, a view into p."""
    return part(p[IN_PARAMETERS:], p, which)


def state(p: Array, x: Array, which: int) -> Array:
    """A part of `STATE`, a view into x."""
    return part(p[IN_STATE:], x, which)


def advance(p: Array, x: Array, inputs: Array, s: Array, q_scale: float) -> None:
    """Prediction of x̂ and P. `work` is: held input, following, F, q·Q, and the model's own."""
    n = int(p[N_X])
    n_u = int(p[N_U])
    before = state(p, x, BEFORE)
    work = state(p, x, WORK)
    held = work[:n_u]
    following = work[n_u : n_u + n]
    F = work[n_u + n : n_u + n + n * n]
    Q = work[n_u + n + n * n : n_u + n + 2 * n * n]
    rest = work[n_u + n + 2 * n * n :]
    for i in range(n_u):
        held[i] = p[SHARE] * inputs[i] + (1.0 - p[SHARE]) * before[i]
    model_transition(given(p, MODEL), s, x[:n], held, following, F, rest)
    for i in range(n):
        x[i] = following[i]
    process = given(p, PROCESS)
    for i in range(n * n):
        Q[i] = q_scale * process[i]
    predict(n, state(p, x, P_), F, Q, rest)


def expect(p: Array, x: Array, s: Array, r_scale: float, measured: Array, nu: Array) -> None:
    """ẑ, H and r·R into x, innovation into `nu`."""
    m = int(p[N_Z])
    z = state(p, x, Z_)
    model_measurement(given(p, MODEL), s, state(p, x, X_), z, state(p, x, H_))
    for a in range(m):
        nu[a] = measured[a] - z[a]
    R = state(p, x, R_)
    sensor = given(p, SENSOR)
    for a in range(m * m):
        R[a] = r_scale * sensor[a]


def adapt(p: Array, x: Array, nu: Array) -> float:
    """D² of this instant into the window, g from the scaled mean (16), the score; returns D̄²."""
    n = int(p[N_X])
    m = int(p[N_Z])
    P = state(p, x, P_)
    H = state(p, x, H_)
    memory = state(p, x, MEMORY_)
    work = state(p, x, WORK)
    if int(p[DISTANCE]) == INNOVATION_DISTANCE:
        squared = innovation_distance(n, m, P, H, state(p, x, R_), nu, work)
    else:
        squared = state_distance(n, m, P, H, nu, work)
    window = int(p[WINDOW])
    place = int(memory[PLACE])
    count = min(int(memory[COUNT]) + 1, window)
    ring = state(p, x, RING)
    distance = float(window_mean(ring, count, place, squared) / memory[GAIN])
    memory[COUNT] = count
    memory[PLACE] = (place + 1) % window
    rules = int(p[N_RULES])
    work[0] = distance
    infer(
        given(p, STRUCTURE), given(p, THETA), work[:1],
        work[1 : 1 + rules], work[1 + rules : 1 + 2 * rules], work[1 + 2 * rules : 1 + 3 * rules],
        memory[GAIN : GAIN + 1],
    )  # fmt: skip
    scale_score(state(p, x, SCORE), memory[GAIN], p[CONSISTENT] > 0.0)
    return distance


def show(p: Array, x: Array, y: Array) -> None:
    """Estimate, gains and variances into the outputs; `update` left K in its work space."""
    n = int(p[N_X])
    m = int(p[N_Z])
    gain = state(p, x, MEMORY_)[GAIN]
    K = state(p, x, WORK)[2 * n * m : 3 * n * m]
    P = state(p, x, P_)
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
    inputs = u[m : m + int(p[N_U])]
    s = u[m + int(p[N_U]) : m + int(p[N_U]) + int(p[N_S])]
    q_scale = 1.0
    r_scale = 1.0
    if p[SCALED] > 0.0:
        q_scale = u[len(u) - 2]
        r_scale = u[len(u) - 1]
    memory = state(p, x, MEMORY_)
    if memory[STARTED] > 0.0:
        advance(p, x, inputs, s, q_scale)
    memory[STARTED] = 1.0
    nu = y[n : n + m]
    expect(p, x, s, r_scale, u[:m], nu)
    y[n + m + Y_DISTANCE] = 0.0
    if p[ADAPTED] > 0.0:
        y[n + m + Y_DISTANCE] = adapt(p, x, nu)
    y[n + m + Y_SQUARED] = update(
        n, m, x[:n], state(p, x, P_), nu, state(p, x, H_),
        state(p, x, R_), state(p, x, SCORE),
        state(p, x, GAMMA), state(p, x, WORK),
    )  # fmt: skip
    before = state(p, x, BEFORE)
    for i in range(len(inputs)):
        before[i] = inputs[i]
    show(p, x, y)
