"""The step of the tuned fuzzy PID: the fuzzy PID of `fuzzy_pid` and three filters.

Block arrays: p = [as FuzzyPID up to s_d | tuner | score | Q of p, i, d],
x = [as FuzzyPID | tuner | (θ, ∂u/∂θ, active, P) of p, i, d | work], with n = len(θ) of one axis.

This module refuses to choose parameters; `tuned_fuzzy_pid` does, and says what they
mean.
"""

from __future__ import annotations

from controllers.core.block import Array
from controllers.core.limit import limit
from controllers.fuzzy.gradient import infer_gradient
from controllers.kalman.p_point import N_SCORE
from controllers.papers.ahn2009.fuzzy_pid import (
    N_FUZZY_OUTPUT,
    P_GAINS,
    P_N_MU,
    P_N_RULES,
    P_N_S,
    P_N_THETA,
    P_N_WEIGHTS,
    P_SYSTEMS,
    X_INPUTS,
    X_U,
    X_WORK,
    fuzzy_act,
    fuzzy_gain,
    fuzzy_inputs,
    show_firing,
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

# Parameters of the tuner, from P_SYSTEMS + 3·n_s on.
T_R, T_REDUCED, T_CAUSAL, T_FROM_INPUT, T_SMALLEST_DU, T_LOW, T_HIGH = range(7)
T_FLOOR, T_GAP, T_WHEN_SATURATED, T_N, T_M = range(7, 12)
T_SCORE = 12
T_NOISE = T_SCORE + N_SCORE

# State of the tuner, after that of the fuzzy PID; then one block per axis, then the work space.
S_SEEN, S_Y, S_U, S_U_BEFORE, S_SENSITIVITY, S_SATURATED, S_INNOVATION = range(7)
S_GAMMA, S_NIS, S_GIVEN = 7, 10, 13  # S_GIVEN: sensitivity input of the instant before
S_AXES = 14

# Outputs after those of the fuzzy PID: sensitivity, then three of each; then θ of p, i, d.
Y_SENSITIVITY = N_FUZZY_OUTPUT
Y_GAMMA, Y_NIS, Y_TRACE, Y_LEAST = (N_FUZZY_OUTPUT + n for n in (1, 4, 7, 10))
Y_THETA = N_FUZZY_OUTPUT + 13


def tuner_at(p: Array) -> int:
    """Where the tuner's state begins in x."""
    return X_WORK + 3 * (int(p[P_N_MU]) + int(p[P_N_RULES]) + int(p[P_N_WEIGHTS]))


def axis_at(p: Array, axis: int) -> int:
    """Where θ of an axis begins in x; ∂u/∂θ, active flags and P follow."""
    n = int(p[P_N_THETA])
    return tuner_at(p) + S_AXES + axis * (3 * n + n * n)


def keep_gradient(p: Array, x: Array, axis: int) -> None:
    """∂u/∂θ = ∂u/∂U·∂U/∂θ of (41) to (47) for the instant just computed, into x."""
    n_s = int(p[P_N_S])
    n = int(p[P_N_THETA])
    n_mu = int(p[P_N_MU])
    n_rules = int(p[P_N_RULES])
    n_weights = int(p[P_N_WEIGHTS])
    at = axis_at(p, axis)
    mu_at = X_WORK + (n_mu + n_rules + n_weights) * axis
    firing_at = mu_at + n_mu
    strength_at = firing_at + n_rules
    work_at = axis_at(p, 3)
    gradient = x[at + n : at + 2 * n]
    infer_gradient(
        p[P_SYSTEMS + n_s * axis : P_SYSTEMS + n_s * (axis + 1)],
        x[at : at + n],
        x[X_INPUTS:X_U],
        x[mu_at:firing_at],
        x[firing_at:strength_at],
        x[strength_at : strength_at + n_weights],
        x[X_U + axis : X_U + axis + 1],
        0,
        x[work_at : work_at + n_mu],
        gradient,
    )
    lever = x[ERROR]
    if axis == 1:
        lever = x[INTEGRAL_USED]
    if axis == 2:
        lever = x[DERIVATIVE]
    lever = lever * p[P_GAINS + 2 * axis + 1]
    for i in range(n):
        gradient[i] = gradient[i] * lever


def tune_axis(p: Array, x: Array, axis: int) -> None:
    """One filter step of one axis with the innovation and sensitivity in x."""
    n_s = int(p[P_N_S])
    n = int(p[P_N_THETA])
    t = p[P_SYSTEMS + 3 * n_s :]
    tuner = tuner_at(p)
    at = axis_at(p, axis)
    theta = x[at : at + n]
    P = x[at + 3 * n : at + 3 * n + n * n]
    noise = t[T_NOISE + n * axis : T_NOISE + n * (axis + 1)]
    score = t[T_SCORE:T_NOISE]
    gamma = x[tuner + S_GAMMA + axis : tuner + S_GAMMA + axis + 1]
    innovation = x[tuner + S_INNOVATION : tuner + S_INNOVATION + 1]
    work_at = axis_at(p, 3)
    h = x[work_at : work_at + n]
    index = x[work_at + n : work_at + n + REDUCED_SIZE]
    work = x[work_at + n + REDUCED_SIZE :]
    for i in range(n):
        h[i] = x[tuner + S_SENSITIVITY] * x[at + n + i]
    R = t[T_R : T_R + 1]
    if t[T_REDUCED] > 0.0:
        s = p[P_SYSTEMS + n_s * axis : P_SYSTEMS + n_s * (axis + 1)]
        n_mu = int(p[P_N_MU])
        mu_at = X_WORK + (n_mu + int(p[P_N_RULES]) + int(p[P_N_WEIGHTS])) * axis
        count = active_components(s, theta, x[X_INPUTS:X_U], x[mu_at : mu_at + n_mu], index)
        change_active_set(n, P, x[at + 2 * n : at + 3 * n], index, count)
        x[tuner + S_NIS + axis] = update_reduced(
            n, count, index, theta, P, h, noise, innovation, R, score, gamma, work
        )
    else:
        x[tuner + S_NIS + axis] = update_full(
            n, theta, P, h, noise, innovation, R, score, gamma, work
        )
    project(theta, int(t[T_N]), int(t[T_M]), t[T_FLOOR], t[T_GAP])


def tune(p: Array, x: Array, u: Array) -> None:
    """Sensitivity and one filter step of all three axes."""
    t = p[P_SYSTEMS + 3 * int(p[P_N_S]) :]
    x_t = x[tuner_at(p) :]
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
    n = int(p[P_N_THETA])
    x_t = x[tuner_at(p) :]
    y[Y_SENSITIVITY] = x_t[S_SENSITIVITY]
    for axis in range(3):
        at = axis_at(p, axis)
        y[Y_GAMMA + axis] = x_t[S_GAMMA + axis]
        y[Y_NIS + axis] = x_t[S_NIS + axis]
        trace = 0.0
        least = x[at + 3 * n]
        for i in range(n):
            variance = x[at + 3 * n + i * (n + 1)]
            trace = trace + variance
            if variance < least:
                least = variance
            y[Y_THETA + n * axis + i] = x[at + i]
        y[Y_TRACE + axis] = trace
        y[Y_LEAST + axis] = least
    show_firing(p, x, Y_THETA + 3 * n, y)


def tuned_fuzzy_pid_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `TunedFuzzyPID`: inputs reference, measured and, where asked for, sensitivity."""
    t = p[P_SYSTEMS + 3 * int(p[P_N_S]) :]
    x_t = x[tuner_at(p) :]
    n = int(p[P_N_THETA])
    if t[T_CAUSAL] > 0.0:
        tune(p, x, u)
    pid_sense(p, x, u[0], u[1])
    fuzzy_inputs(p, x)
    silent = 0
    for axis in range(3):
        at = axis_at(p, axis)
        silent = silent + fuzzy_gain(p, x, axis, x[at : at + n])
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
