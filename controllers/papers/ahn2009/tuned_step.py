"""The step of the tuned fuzzy PID: the fuzzy PID of `fuzzy_pid_step` and three filters.

Block arrays: p is that of the fuzzy PID without θ, then `TUNER`; x is that of the fuzzy PID, then
`TUNED`, with n = len(θ) of one axis.

This module refuses to choose parameters; `tuned_fuzzy_pid` does, and says what they mean.
"""

from __future__ import annotations

from controllers.core.block import Array
from controllers.core.layout import Layout, part, row_of
from controllers.core.limit import limit
from controllers.fuzzy.gradient import infer_gradient
from controllers.kalman.p_point import N_SCORE
from controllers.papers.ahn2009.fuzzy_pid_step import (
    FIRING,
    MU,
    N_FUZZY_OUTPUT,
    P_GAINS,
    P_IN_PARAMETERS,
    STRENGTH,
    STRUCTURE,
    SYSTEMS,
    X_INPUTS,
    X_U,
    fuzzy_act,
    fuzzy_gain,
    fuzzy_inputs,
    show_firing,
    system_parameters,
    system_state,
)
from controllers.papers.ahn2009.tuner import (
    REDUCED_SIZE,
    active_components,
    change_active_set,
    project,
    quotient,
    update_full,
    update_reduced,
)
from controllers.pid.pid import (
    DERIVATIVE,
    ERROR,
    INTEGRAL_USED,
    Y_SATURATED,
    Y_U,
    pid_sense,
)

# State of the tuner, after that of the fuzzy PID; `given` is the input ∂y/∂u of the instant before.
TUNED = Layout.of(
    seen=(), y=(), u=(), u_before=(), sensitivity=(), saturated=(), innovation=(), gamma=3, nis=3,
    given=(), theta=(3, "n"), gradient=(3, "n"), active=(3, "n"), P=(3, "n", "n"),
    h="n", index=REDUCED_SIZE, work="work",
)  # fmt: skip
(S_SEEN, S_Y, S_U, S_U_BEFORE, S_SENSITIVITY, S_SATURATED, S_INNOVATION, S_GAMMA, S_NIS,
 S_GIVEN, _) = TUNED.places()  # fmt: skip
THETA, GRADIENT, ACTIVE, COVARIANCE = map(TUNED.number, ("theta", "gradient", "active", "P"))
H, INDEX, WORK = map(TUNED.number, ("h", "index", "work"))

# Parameters of the tuner, after those of the fuzzy PID.
TUNER = Layout.of(
    r=(), reduced=(), causal=(), from_input=(), smallest_du=(), low=(), high=(), floor=(), gap=(),
    when_saturated=(), classes=2, score=N_SCORE, in_state=TUNED.entries, noise=(3, "n"),
)  # fmt: skip
(T_R, T_REDUCED, T_CAUSAL, T_FROM_INPUT, T_SMALLEST_DU, T_LOW, T_HIGH, T_FLOOR, T_GAP,
 T_WHEN_SATURATED, T_CLASSES, T_SCORE, T_IN_STATE, T_NOISE) = TUNER.places()  # fmt: skip

# Outputs after those of the fuzzy PID; least is the least variance in P; then θ of p, i, d.
OUTPUTS = Layout.of(
    fuzzy=N_FUZZY_OUTPUT, sensitivity=(), gamma=3, nis=3, trace=3, least=3, theta=()
)
_, Y_SENSITIVITY, Y_GAMMA, Y_NIS, Y_TRACE, Y_LEAST, Y_THETA = OUTPUTS.places()
P_TUNER = P_IN_PARAMETERS + len(SYSTEMS.names)  # in p: where the parameters of the tuner begin


def tuner(p: Array) -> Array:
    """The parameters of the tuner, a view into p."""
    return p[int(p[P_TUNER]) :]


def tuner_state(p: Array, x: Array) -> Array:
    """The state of the tuner, a view into x that begins with its S_ numbers."""
    return x[int(tuner(p)[T_IN_STATE]) :]


def tuned(p: Array, x: Array, which: int) -> Array:
    """A part of `TUNED`, a view into x."""
    return part(tuner(p)[T_IN_STATE:], x, which)


def keep_gradient(p: Array, x: Array, axis: int) -> None:
    """∂u/∂θ = ∂u/∂U·∂U/∂θ of (41) to (47) for the instant just computed, into x."""
    gradient = row_of(tuned(p, x, GRADIENT), axis, 3)
    infer_gradient(
        system_parameters(p, STRUCTURE, axis),
        row_of(tuned(p, x, THETA), axis, 3),
        x[X_INPUTS:X_U],
        system_state(p, x, MU, axis),
        system_state(p, x, FIRING, axis),
        system_state(p, x, STRENGTH, axis),
        x[X_U + axis : X_U + axis + 1],
        0,
        tuned(p, x, H),
        gradient,
    )
    lever = x[ERROR]
    if axis == 1:
        lever = x[INTEGRAL_USED]
    if axis == 2:
        lever = x[DERIVATIVE]
    lever = lever * p[P_GAINS + 2 * axis + 1]
    for i in range(gradient.shape[0]):
        gradient[i] = gradient[i] * lever


def tune_axis(p: Array, x: Array, axis: int) -> None:
    """One filter step of one axis with the innovation and sensitivity in x."""
    t = tuner(p)
    x_t = tuner_state(p, x)
    theta = row_of(tuned(p, x, THETA), axis, 3)
    gradient = row_of(tuned(p, x, GRADIENT), axis, 3)
    P = row_of(tuned(p, x, COVARIANCE), axis, 3)
    noise = row_of(t[T_NOISE:], axis, 3)
    score = t[T_SCORE:T_IN_STATE]
    gamma = x_t[S_GAMMA + axis : S_GAMMA + axis + 1]
    innovation = x_t[S_INNOVATION : S_INNOVATION + 1]
    R = t[T_R : T_R + 1]
    h = tuned(p, x, H)
    index = tuned(p, x, INDEX)
    work = tuned(p, x, WORK)
    n = theta.shape[0]
    for i in range(n):
        h[i] = x_t[S_SENSITIVITY] * gradient[i]
    if t[T_REDUCED] > 0.0:
        s = system_parameters(p, STRUCTURE, axis)
        mu = system_state(p, x, MU, axis)
        count = active_components(s, theta, x[X_INPUTS:X_U], mu, index)
        change_active_set(n, P, row_of(tuned(p, x, ACTIVE), axis, 3), index, count)
        x_t[S_NIS + axis] = update_reduced(
            n, count, index, theta, P, h, noise, innovation, R, score, gamma, work
        )
    else:
        x_t[S_NIS + axis] = update_full(n, theta, P, h, noise, innovation, R, score, gamma, work)
    project(theta, int(t[T_CLASSES]), int(t[T_CLASSES + 1]), t[T_FLOOR], t[T_GAP])


def tune(p: Array, x: Array, u: Array) -> None:
    """Sensitivity and one filter step of all three axes."""
    t = tuner(p)
    x_t = tuner_state(p, x)
    instants = 1.0 + t[T_CAUSAL]
    if t[T_FROM_INPUT] > 0.0:
        given = u[2]
        if t[T_CAUSAL] > 0.0:
            given = x_t[S_GIVEN]
        if x_t[S_SEEN] >= t[T_CAUSAL]:
            x_t[S_SENSITIVITY] = limit(given, t[T_LOW], t[T_HIGH])
    elif x_t[S_SEEN] >= instants:
        x_t[S_SENSITIVITY] = quotient(
            x_t[S_SENSITIVITY],
            u[1] - x_t[S_Y],
            x_t[S_U] - x_t[S_U_BEFORE],
            t[T_SMALLEST_DU],
            t[T_LOW],
            t[T_HIGH],
        )
    x_t[S_INNOVATION] = u[0] - u[1]
    if x_t[S_SEEN] < t[T_CAUSAL]:
        return
    if x_t[S_SATURATED] != 0.0 and t[T_WHEN_SATURATED] == 0.0:
        return
    for axis in range(3):
        tune_axis(p, x, axis)


def show_tuner(p: Array, x: Array, y: Array) -> None:
    """Sensitivity, γ, γ², trace and least variance of P, and θ, into y."""
    x_t = tuner_state(p, x)
    y[Y_SENSITIVITY] = x_t[S_SENSITIVITY]
    theta = tuned(p, x, THETA)
    n = theta.shape[0] // 3
    for i in range(3 * n):
        y[Y_THETA + i] = theta[i]
    for axis in range(3):
        P = row_of(tuned(p, x, COVARIANCE), axis, 3)
        y[Y_GAMMA + axis] = x_t[S_GAMMA + axis]
        y[Y_NIS + axis] = x_t[S_NIS + axis]
        trace = 0.0
        least = P[0]
        for i in range(n):
            variance = P[i * (n + 1)]
            trace = trace + variance
            if variance < least:
                least = variance
        y[Y_TRACE + axis] = trace
        y[Y_LEAST + axis] = least
    show_firing(p, x, Y_THETA + 3 * n, y)


def tuned_fuzzy_pid_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `TunedFuzzyPID`: inputs reference, measured and, where asked for, sensitivity."""
    t = tuner(p)
    x_t = tuner_state(p, x)
    if t[T_CAUSAL] > 0.0:
        tune(p, x, u)
    pid_sense(p, x, u[0], u[1])
    fuzzy_inputs(p, x)
    silent = 0
    for axis in range(3):
        silent = silent + fuzzy_gain(p, x, axis, row_of(tuned(p, x, THETA), axis, 3))
    fuzzy_act(p, x, silent, y)
    for axis in range(3):
        keep_gradient(p, x, axis)
    x_t[S_U_BEFORE] = x_t[S_U]
    x_t[S_U] = y[Y_U]
    x_t[S_SATURATED] = y[Y_SATURATED]
    if t[T_CAUSAL] == 0.0:
        tune(p, x, u)
    x_t[S_Y] = u[1]
    if t[T_FROM_INPUT] > 0.0:
        x_t[S_GIVEN] = u[2]
    x_t[S_SEEN] = x_t[S_SEEN] + 1.0
    show_tuner(p, x, y)
