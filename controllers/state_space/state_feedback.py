"""State controller with integral action whose gains may follow a parameter of the plant.

Equation (4) of Serkies & Szabat 2013, for any number of states, at sample instant k:

    e_k = r_k − y_k
    I_k = I_{k−1} + k_I·T·(e_k + e_{k−1})/2 + Σ (k_i − k_i⁻)·x_i,      I_0 = Σ k_i·x_i
    u_k = I_k − Σ k_i·x_i,                                             limited to [u_min, u_max]

k_i⁻ are the gains of the instant before. The last sum of I_k keeps the control where it is when
the gains are retuned ("bumpless"); without it a new gain acts on the whole state at once.
k_I is inside the integral, so that a new k_I does not rescale what has been gathered. Where u is
limited, an increment of the integral that would drive it further is left out.

`state_feedback_step` is a template: `model_gains(p, s, k)` is bound to a function that gives
k = (k_I, k_1, …, k_n) for the scheduled parameters s (`controllers.core.bind`). Gains that do not
change are the function `constant_gains`.

`controllers.papers.serkies2013` has an example of gains that follow. This module refuses to design
gains (`pole_placement`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from controllers.core.bind import bind
from controllers.core.block import Array, Block, Signal, StepFunction
from controllers.core.errors import require, require_finite, require_positive
from controllers.core.limit import limit

Gains = Callable[[Array, Array, Array], None]

# Parameters: the head, then those of the gains.
TS, N_STATES, N_SCHEDULED, U_MIN, U_MAX, BUMPLESS = range(6)
N_HEAD = 6

# State: the head, then gains in force (n + 1), then those of the instant before (n + 1).
STARTED, INTEGRAL, ERROR = range(3)
N_MEMORY = 3

# Outputs: the head, then k_I, k_1, …, k_n.
Y_U, Y_I, Y_FEEDBACK, Y_ERROR, Y_SATURATED = range(5)
N_OUTPUTS = 5


def model_gains(p: Array, s: Array, k: Array) -> None:
    """k (n + 1,) for the scheduled parameters s; bound by `bind`."""


def constant_gains(p: Array, s: Array, k: Array) -> None:
    """k = p: gains that do not change."""
    for i in range(len(k)):
        k[i] = p[i]


def state_feedback_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Inputs: reference, controlled output, x_1 … x_n, scheduled parameters."""
    n = int(p[N_STATES])
    states = u[2 : 2 + n]
    k = x[N_MEMORY : N_MEMORY + n + 1]
    before = x[N_MEMORY + n + 1 :]
    for i in range(n + 1):
        before[i] = k[i]
    model_gains(p[N_HEAD:], u[2 + n :], k)
    feedback = 0.0
    retuned = 0.0
    for i in range(n):
        feedback = feedback + k[1 + i] * states[i]
        retuned = retuned + (k[1 + i] - before[1 + i]) * states[i]
    error = u[0] - u[1]
    increment = 0.0
    if x[STARTED] > 0.0:
        increment = k[0] * p[TS] * 0.5 * (error + x[ERROR])
        if p[BUMPLESS] > 0.0:
            x[INTEGRAL] = x[INTEGRAL] + retuned
    else:
        x[INTEGRAL] = feedback
        x[STARTED] = 1.0
    wanted = x[INTEGRAL] + increment - feedback
    limited = limit(wanted, p[U_MIN], p[U_MAX])
    if (wanted - limited) * increment > 0.0:
        wanted = x[INTEGRAL] - feedback
        limited = limit(wanted, p[U_MIN], p[U_MAX])
    else:
        x[INTEGRAL] = x[INTEGRAL] + increment
    x[ERROR] = error
    y[Y_U] = limited
    y[Y_I] = x[INTEGRAL]
    y[Y_FEEDBACK] = feedback
    y[Y_ERROR] = error
    y[Y_SATURATED] = 0.0
    if wanted > limited:
        y[Y_SATURATED] = 1.0
    if wanted < limited:
        y[Y_SATURATED] = -1.0
    for i in range(n + 1):
        y[N_OUTPUTS + i] = k[i]


@cache
def _step(gains: Gains) -> StepFunction:
    """The step bound to a function of gains: one function each, so that it is compiled once."""
    return bind(state_feedback_step, model_gains=gains)


def state_feedback_block(
    gains: Gains,
    gain_parameters: Array,
    states: tuple[Signal, ...],
    scheduled: tuple[Signal, ...],
    *,
    sample_time: float,
    u_min: float = -math.inf,
    u_max: float = math.inf,
    bumpless: bool = True,
    measured_unit: str = "1",
    output_unit: str = "1",
) -> Block:
    """The block of any state controller: `gains(p, s, k)` with its parameters p, the signals of
    the states that are fed back, and of the scheduled parameters."""
    require_positive("state_feedback_block: sample_time", sample_time)
    require(u_min < u_max, "state_feedback_block: u_min, u_max", "u_min below", (u_min, u_max))
    n = len(states)
    require(n >= 1, "state_feedback_block: states", "at least one", states)
    names = ("k_i", *(f"k_{i}" for i in range(1, n + 1)))
    head = [sample_time, n, len(scheduled), u_min, u_max, float(bumpless)]
    return Block(
        inputs=(
            Signal("reference", measured_unit, "set point"),
            Signal("measured", measured_unit, "controlled output, or its estimate"),
            *states,
            *scheduled,
        ),
        outputs=(
            Signal("u", output_unit, "control, limited"),
            Signal("i_part", output_unit, "integral part"),
            Signal("feedback", output_unit, "Σ k_i·x_i, taken from the integral part"),
            Signal("error", measured_unit, "reference − measured"),
            Signal("saturated", "1", "1 at the upper limit, −1 at the lower, else 0"),
            *(Signal(name, "", "gain in force") for name in names),
        ),
        step=_step(gains),
        parameters=np.concatenate([np.array(head), gain_parameters]),
        parameter_names=(
            "sample_time", "n_states", "n_scheduled", "u_min", "u_max", "bumpless",
            *(f"gain_parameter_{i}" for i in range(1, len(gain_parameters) + 1)),
        ),
        state=np.zeros(N_MEMORY + 2 * (n + 1)),
        state_names=(
            "started", "integral", "error", *names, *(f"{name}_before" for name in names)
        ),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class StateController:
    """State controller with fixed gains: `k_i` of the integral [u/(y·s)], `k` of the states.

    u_min, u_max limit the control; the block has the inputs reference, measured, x_1, …, x_n.
    """

    k_i: float
    k: tuple[float, ...]
    u_min: float = -math.inf
    u_max: float = math.inf

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        require(len(self.k) > 0, "StateController.k", "at least one gain", self.k)
        for value in (self.k_i, *self.k):
            require_finite("StateController.k_i, k", value)

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        states = tuple(Signal(f"x_{i}", "", "state") for i in range(1, len(self.k) + 1))
        return state_feedback_block(
            constant_gains, np.array([self.k_i, *self.k]), states, (),
            sample_time=sample_time, u_min=self.u_min, u_max=self.u_max,
        )  # fmt: skip
