"""The step of the fuzzy PID, eqs (2)–(7) of Ahn & Truong 2009, over flat arrays.

Block arrays: p is `HEAD`, then `SYSTEMS`; x is `STATE`. The online tuner keeps θ in x instead, and
otherwise calls the same functions: with nothing to tune it is bit-equal.

This module refuses to choose parameters; `fuzzy_pid` does, and says what they mean.
"""

from __future__ import annotations

from controllers.core.block import Array
from controllers.core.layout import Layout, part, row_of
from controllers.fuzzy.inference import infer
from controllers.pid.pid import (
    DERIVATIVE,
    ERROR,
    N_LAW,
    N_LAW_OUTPUT,
    N_LAW_STATE,
    pid_act,
    pid_sense,
)

# State: scaled |e| and |de/dt|; U_p, U_i, U_d; work space of the systems p, i, d.
STATE = Layout.of(
    law=N_LAW_STATE, inputs=2, U=3,
    mu=(3, "functions"), firing=(3, "rules"), strength=(3, "weights"),
)  # fmt: skip
X_INPUTS, X_U = STATE.place("inputs"), STATE.place("U")
MU, FIRING, STRENGTH = map(STATE.number, ("mu", "firing", "strength"))

# Parameters: (K_a0, K_a1 − K_a0) of p, i, d; scale factors; tables of places; s and θ of p, i, d.
SYSTEMS = Layout.of(structure=(3, "structure"), theta=(3, "theta"))
HEAD = Layout.of(
    law=N_LAW, gains=(3, 2), scales=2, in_parameters=SYSTEMS.entries, in_state=STATE.entries
)
STRUCTURE, THETA = map(SYSTEMS.number, SYSTEMS.names)
P_GAINS, P_SCALES = HEAD.place("gains"), HEAD.place("scales")
P_IN_PARAMETERS, P_IN_STATE = HEAD.place("in_parameters"), HEAD.place("in_state")

# Outputs: U_p, U_i, U_d; scaled |e|, |de/dt|; systems without a firing rule.
OUTPUTS = Layout.of(law=N_LAW_OUTPUT, U=3, inputs=2, silent=(), end=())
Y_U_INFERRED, Y_INPUTS, Y_SILENT, N_FUZZY_OUTPUT = OUTPUTS.places()[1:]


def scaled(value: float, scale: float) -> float:
    """|value|·scale limited to 1."""
    magnitude = abs(value) * scale
    if magnitude > 1.0:
        return 1.0
    return magnitude


def fuzzy_inputs(p: Array, x: Array) -> None:
    """The two inputs of the fuzzy systems, after `pid_sense`."""
    x[X_INPUTS] = scaled(x[ERROR], p[P_SCALES])
    x[X_INPUTS + 1] = scaled(x[DERIVATIVE], p[P_SCALES + 1])


def system_parameters(p: Array, which: int, axis: int) -> Array:
    """Structure or θ of the system of an axis, a view into p."""
    return row_of(part(p[P_IN_PARAMETERS:], p, which), axis, 3)


def system_state(p: Array, x: Array, which: int, axis: int) -> Array:
    """Memberships, firings or strengths of the system of an axis, a view into x."""
    return row_of(part(p[P_IN_STATE:], x, which), axis, 3)


def fuzzy_gain(p: Array, x: Array, axis: int, theta: Array) -> int:
    """U of one axis (0, 1, 2 for p, i, d) into x; returns 1 where no rule fires."""
    return infer(
        system_parameters(p, STRUCTURE, axis),
        theta,
        x[X_INPUTS:X_U],
        system_state(p, x, MU, axis),
        system_state(p, x, FIRING, axis),
        system_state(p, x, STRENGTH, axis),
        x[X_U + axis : X_U + axis + 1],
    )


def gain_in_force(p: Array, x: Array, axis: int) -> float:
    """K_a of (2)."""
    return float(p[P_GAINS + 2 * axis] + x[X_U + axis] * p[P_GAINS + 2 * axis + 1])


def fuzzy_act(p: Array, x: Array, silent: int, y: Array) -> None:
    """Control for the U in x, and the outputs of the law and of the fuzzy systems."""
    kp = gain_in_force(p, x, 0)
    ki = gain_in_force(p, x, 1)
    kd = gain_in_force(p, x, 2)
    pid_act(p, x, kp, ki, kd, y)
    for a in range(3):
        y[Y_U_INFERRED + a] = x[X_U + a]
    y[Y_INPUTS] = x[X_INPUTS]
    y[Y_INPUTS + 1] = x[X_INPUTS + 1]
    y[Y_SILENT] = float(silent)


def show_firing(p: Array, x: Array, at: int, y: Array) -> None:
    """Rule firings of the three systems into y from `at` on, as far as y has room."""
    firing = part(p[P_IN_STATE:], x, FIRING)
    if y.shape[0] >= at + firing.shape[0]:
        for i in range(firing.shape[0]):
            y[at + i] = firing[i]


def fuzzy_pid_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `FuzzyPID`: inputs reference, measured."""
    pid_sense(p, x, u[0], u[1])
    fuzzy_inputs(p, x)
    silent = 0
    for a in range(3):
        silent = silent + fuzzy_gain(p, x, a, system_parameters(p, THETA, a))
    fuzzy_act(p, x, silent, y)
    show_firing(p, x, N_FUZZY_OUTPUT, y)
