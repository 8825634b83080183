"""The step of `identifier`: a NARX model adapted and simulated at each sample instant.

At instant k, with y_k measured and u_{k−1} held since the instant before, in scaled units:

    x_k   = (past y, past u up to u_{k−1})        the regressor of y_k, see `narx`
    ŷ_k   = h(x_k, p)                             one-step prediction, before y_k is learnt
    ỹ_k   = h(x̃_k, p), x̃ of past ỹ instead of y   free run; ỹ_k = y_k until it is let go
    p     ← filter step with y_k − ŷ_k            `adaptation`
    ∂ŷ_{k+1}/∂x at (y_k, …, u_k = u_{k−1}, …)     sensitivity over the sample that begins

Block arrays: p is `HEAD`, then `TABLES`: (centre, half) of the signals, s, c; x is `STATE`.

This module refuses to choose parameters; `identifier` does.
"""

from __future__ import annotations

from controllers.core.block import Array
from controllers.core.layout import Layout, part
from controllers.core.limit import limit
from controllers.fuzzy.takagi_sugeno_kernels import model_jacobian, model_outputs, model_slopes
from controllers.identification.adaptation import C_FREE, adapt
from controllers.identification.narx import SIMULATION_LIMIT, push

# State: samples seen, νᵀS⁻¹ν, outputs without a firing rule; the regressors measured, simulated
# and ahead; signals of the instant; θ; P; ∂h/∂θ; ∂h/∂x ahead; work space.
STATE = Layout.of(
    seen=(), squared=(), silent=(), measured="regressors", simulated="regressors",
    point="regressors", z="outputs", predicted="outputs", run="outputs", ahead="outputs",
    innovation="outputs", gamma="outputs", theta="theta", P="covariance",
    H=("outputs", "theta"), G=("outputs", "regressors"), work="work",
)  # fmt: skip
X_SEEN, X_SQUARED, X_SILENT, _ = STATE.places()
(X_MEASURED, X_SIMULATED, X_POINT, X_Z, X_PREDICTED, X_RUN, X_AHEAD, X_INNOVATION, X_GAMMA,
 X_THETA, X_P, X_H, X_G, X_WORK) = map(STATE.number, STATE.names[3:])  # fmt: skip

# Parameters: `HEAD`, in which learning and the free run are sample numbers, then `TABLES`.
TABLES = Layout.of(scales=("signals", 2), s="structure", c="constants")
SCALES, STRUCTURE, CONSTANTS = map(TABLES.number, TABLES.names)
HEAD = Layout.of(
    outputs=(), inputs=(), output_lags=(), input_lags=(), learn_from=(), learn_until=(),
    free_from=(), first=(), in_parameters=TABLES.entries, in_state=STATE.entries,
)  # fmt: skip
(P_OUTPUTS, P_INPUTS, P_OUTPUT_LAGS, P_INPUT_LAGS, P_LEARN_FROM, P_LEARN_UNTIL, P_FREE_FROM,
 P_FIRST, P_IN_PARAMETERS, P_IN_STATE) = HEAD.places()  # fmt: skip

# Outputs: of each output four; the sensitivities; νᵀS⁻¹ν, trace of P, silent; θ.
PER_OUTPUT = 4


def given(p: Array, which: int) -> Array:
    """A part of `TABLES`, a view into p."""
    return part(p[P_IN_PARAMETERS:], p, which)


def state(p: Array, x: Array, which: int) -> Array:
    """A part of `STATE`, a view into x."""
    return part(p[P_IN_STATE:], x, which)


def push_inputs(p: Array, history: Array, u: Array) -> None:
    """u_{k−1} (q,), scaled, into a history."""
    lags = int(p[P_INPUT_LAGS])
    m = int(p[P_OUTPUTS])
    scales = given(p, SCALES)
    for i in range(int(p[P_INPUTS])):
        place = m * int(p[P_OUTPUT_LAGS]) + lags * i
        push(history, place, lags, (u[m + i] - scales[2 * (m + i)]) / scales[2 * (m + i) + 1])


def push_outputs(p: Array, history: Array, z: Array) -> None:
    """Scaled outputs (m,) into a history."""
    lags = int(p[P_OUTPUT_LAGS])
    for o in range(int(p[P_OUTPUTS])):
        push(history, lags * o, lags, z[o])


def predict_instant(p: Array, x: Array) -> None:
    """ŷ_k, ỹ_k and the innovation; before enough samples are seen they are y_k, y_k and 0."""
    s = given(p, STRUCTURE)
    theta = state(p, x, X_THETA)
    work = state(p, x, X_WORK)
    z = state(p, x, X_Z)
    predicted = state(p, x, X_PREDICTED)
    run = state(p, x, X_RUN)
    innovation = state(p, x, X_INNOVATION)
    known = x[X_SEEN] >= p[P_FIRST]
    x[X_SILENT] = 0.0
    if known:
        model_outputs(s, theta, state(p, x, X_SIMULATED), run, work)
        x[X_SILENT] = float(model_outputs(s, theta, state(p, x, X_MEASURED), predicted, work))
    for o in range(int(p[P_OUTPUTS])):
        if not known:
            predicted[o] = z[o]
        innovation[o] = z[o] - predicted[o]
        run[o] = limit(run[o], -SIMULATION_LIMIT, SIMULATION_LIMIT)
        if not known or x[X_SEEN] < p[P_FREE_FROM]:
            run[o] = z[o]


def learn(p: Array, x: Array) -> None:
    """Filter step with the innovation of this instant, after `predict_instant`."""
    s = given(p, STRUCTURE)
    theta = state(p, x, X_THETA)
    work = state(p, x, X_WORK)
    H = state(p, x, X_H)
    model_jacobian(s, theta, state(p, x, X_MEASURED), state(p, x, X_PREDICTED), H, work)
    x[X_SQUARED] = adapt(
        given(p, CONSTANTS), theta, state(p, x, X_P), state(p, x, X_INNOVATION), H,
        state(p, x, X_GAMMA), work,
    )  # fmt: skip


def look_ahead(p: Array, x: Array, u: Array) -> None:
    """∂ŷ_{k+1}/∂x with the input held on, after y_k has entered the history."""
    s = given(p, STRUCTURE)
    theta = state(p, x, X_THETA)
    work = state(p, x, X_WORK)
    point = state(p, x, X_POINT)
    measured = state(p, x, X_MEASURED)
    ahead = state(p, x, X_AHEAD)
    for j in range(point.shape[0]):
        point[j] = measured[j]
    push_inputs(p, point, u)
    model_outputs(s, theta, point, ahead, work)
    model_slopes(s, theta, point, ahead, state(p, x, X_G), work)


def show(p: Array, x: Array, y: Array) -> None:
    """Everything into y, in physical units."""
    m = int(p[P_OUTPUTS])
    q = int(p[P_INPUTS])
    measured = state(p, x, X_MEASURED)
    slopes = state(p, x, X_G)
    theta = state(p, x, X_THETA)
    scales = given(p, SCALES)
    for o in range(m):
        half = scales[2 * o + 1]
        centre = scales[2 * o]
        y[PER_OUTPUT * o] = centre + half * state(p, x, X_PREDICTED)[o]
        y[PER_OUTPUT * o + 1] = centre + half * state(p, x, X_RUN)[o]
        y[PER_OUTPUT * o + 2] = half * state(p, x, X_INNOVATION)[o]
        y[PER_OUTPUT * o + 3] = state(p, x, X_GAMMA)[o]
        for i in range(q):
            place = m * int(p[P_OUTPUT_LAGS]) + int(p[P_INPUT_LAGS]) * i
            slope = slopes[measured.shape[0] * o + place]
            y[PER_OUTPUT * m + q * o + i] = slope * half / scales[2 * (m + i) + 1]
    at = PER_OUTPUT * m + q * m
    y[at] = x[X_SQUARED]
    y[at + 1] = 0.0
    P = state(p, x, X_P)
    n = int(given(p, CONSTANTS)[C_FREE])
    for a in range(n):
        y[at + 1] = y[at + 1] + P[a * n + a]
    y[at + 2] = x[X_SILENT]
    for a in range(theta.shape[0]):
        y[at + 3 + a] = theta[a]


def identifier_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `Identifier`: inputs y_k (m,), then u_{k−1} (q,)."""
    z = state(p, x, X_Z)
    scales = given(p, SCALES)
    for o in range(int(p[P_OUTPUTS])):
        z[o] = (u[o] - scales[2 * o]) / scales[2 * o + 1]
    push_inputs(p, state(p, x, X_MEASURED), u)
    push_inputs(p, state(p, x, X_SIMULATED), u)
    predict_instant(p, x)
    seen = x[X_SEEN]
    if seen >= p[P_FIRST] and seen >= p[P_LEARN_FROM] and seen < p[P_LEARN_UNTIL]:
        learn(p, x)
    push_outputs(p, state(p, x, X_MEASURED), z)
    push_outputs(p, state(p, x, X_SIMULATED), state(p, x, X_RUN))
    look_ahead(p, x, u)
    x[X_SEEN] = seen + 1.0
    show(p, x, y)
