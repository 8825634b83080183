"""Discrete PID, eq. (1) of Ahn & Truong 2009, with one law shared by every PID of this package.

At sample instant k, with e = reference − measured and sample time T:

    integral    I_k = I_{k-1} + T·(θ·e_k + (1 − θ)·e_{k-1}),    I_0 = 0
                θ = 1/2 trapezoidal, 1 backward rectangular, 0 forward rectangular
    derivative  D_k = α·D_{k-1} + (1 − α)·(v_k − v_{k-1})/T,    D_0 = 0,   α = exp(−T/T_f)
                v = e or −measured; this is s/(T_f·s + 1) solved exactly for a signal v that is
                linear between the samples: stable for every T_f, the difference quotient for 0
    output      u = bias + K_p·e + K_i·I + K_d·D, limited to [u_min, u_max]

The integral is of e and is multiplied by K_i afterwards, as (1) and (41) of the paper have it.
With a gain that varies (fuzzy PID) a change of K_i therefore moves u by ΔK_i·I at once.

Anti-windup: "conditional" does not integrate an increment that would drive u further into the
limit; "back_calculation" adds T·k_t·(u − u_unlimited) to I, k_t = 1/(K_i·T_t); "none".

This module refuses to schedule gains: `pid_sense` and `pid_act` take them from whoever knows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import (
    require,
    require_choice,
    require_finite,
    require_not_negative,
    require_positive,
)
from controllers.core.limit import limit

# Parameters of the law, p[0:N_LAW]; the gains of a plain PID follow.
TS, THETA, ALPHA, ON_MEASUREMENT, U_MIN, U_MAX, BIAS, WINDUP, K_T = range(9)
N_LAW = 9
P_KP, P_KI, P_KD = 9, 10, 11

# State of the law, x[0:N_LAW_STATE]. INTEGRAL_USED is the integral that entered u.
STARTED, INTEGRAL, INCREMENT, INTEGRAL_USED, ERROR, DIFFERENTIATED, DERIVATIVE = range(7)
N_LAW_STATE = 7

# Outputs of the law, y[0:N_LAW_OUTPUT].
Y_U, Y_P, Y_I, Y_D, Y_ERROR, Y_SATURATED, Y_KP, Y_KI, Y_KD = range(9)
N_LAW_OUTPUT = 9

NONE, CONDITIONAL, BACK_CALCULATION = 0, 1, 2

INTEGRATION = {"trapezoidal": 0.5, "backward": 1.0, "forward": 0.0}
ANTI_WINDUP = {"none": NONE, "conditional": CONDITIONAL, "back_calculation": BACK_CALCULATION}
DERIVATIVE_ON = {"error": 0.0, "measurement": 1.0}

LAW_PARAMETER_NAMES = (
    "sample_time",
    "theta",
    "alpha",
    "derivative_on_measurement",
    "u_min",
    "u_max",
    "bias",
    "anti_windup",
    "k_t",
)
LAW_TUNABLE = ("u_min", "u_max", "bias")
LAW_STATE_NAMES = (
    "started",
    "integral",
    "increment",
    "integral_used",
    "error",
    "differentiated",
    "derivative",
)


def pid_sense(p: Array, x: Array, reference: float, measured: float) -> None:
    """Error, its integral's increment and the filtered derivative at this instant, into x."""
    error = reference - measured
    differentiated = error
    if p[ON_MEASUREMENT] > 0.0:
        differentiated = -measured
    if x[STARTED] > 0.0:
        x[INCREMENT] = p[TS] * (p[THETA] * error + (1.0 - p[THETA]) * x[ERROR])
        slope = (differentiated - x[DIFFERENTIATED]) / p[TS]
        x[DERIVATIVE] = p[ALPHA] * x[DERIVATIVE] + (1.0 - p[ALPHA]) * slope
    else:
        x[INCREMENT] = 0.0
        x[DERIVATIVE] = 0.0
        x[STARTED] = 1.0
    x[ERROR] = error
    x[DIFFERENTIATED] = differentiated


def pid_act(p: Array, x: Array, kp: float, ki: float, kd: float, y: Array) -> None:
    """Output for the gains in force, after `pid_sense`; advances the integral."""
    held = x[INTEGRAL]
    integral = held + x[INCREMENT]
    p_part = kp * x[ERROR]
    d_part = kd * x[DERIVATIVE]
    i_part = ki * integral
    wanted = p[BIAS] + ((p_part + i_part) + d_part)
    u = limit(wanted, p[U_MIN], p[U_MAX])
    if int(p[WINDUP]) == CONDITIONAL and (wanted - u) * (ki * x[INCREMENT]) > 0.0:
        integral = held
        i_part = ki * integral
        wanted = p[BIAS] + ((p_part + i_part) + d_part)
        u = limit(wanted, p[U_MIN], p[U_MAX])
    x[INTEGRAL_USED] = integral
    if int(p[WINDUP]) == BACK_CALCULATION and wanted != u:
        integral = integral + p[TS] * p[K_T] * (u - wanted)
    x[INTEGRAL] = integral
    y[Y_U] = u
    y[Y_P] = p_part
    y[Y_I] = i_part
    y[Y_D] = d_part
    y[Y_ERROR] = x[ERROR]
    y[Y_SATURATED] = 0.0
    if wanted > u:
        y[Y_SATURATED] = 1.0
    if wanted < u:
        y[Y_SATURATED] = -1.0
    y[Y_KP] = kp
    y[Y_KI] = ki
    y[Y_KD] = kd


def pid_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `PID`: inputs reference, measured."""
    pid_sense(p, x, u[0], u[1])
    pid_act(p, x, p[P_KP], p[P_KI], p[P_KD], y)


@dataclass(frozen=True, kw_only=True)
class PIDLaw:
    """What every PID of this package has besides its gains.

    derivative_filter   T_f of the first-order filter of the derivative [s], 0 for none
    derivative_on       "error", or "measurement" (no kick when the reference jumps)
    integration         "trapezoidal", "backward" or "forward" rectangle
    anti_windup         "conditional", "back_calculation" or "none"
    tracking_time       T_t of back-calculation, at least the sample time [s]
    u_min, u_max        limits of the output [output_unit]
    bias                added to the output [output_unit]
    measured_unit       unit of reference and measured, an FMI-style string; "" takes that of the
                        wire and leaves the units of gains open
    output_unit         unit of u, likewise
    """

    derivative_filter: float = 0.0
    derivative_on: str = "error"
    integration: str = "trapezoidal"
    anti_windup: str = "conditional"
    tracking_time: float = 0.1
    u_min: float = -math.inf
    u_max: float = math.inf
    bias: float = 0.0
    measured_unit: str = ""
    output_unit: str = ""

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        name = type(self).__name__
        require_not_negative(f"{name}.derivative_filter", self.derivative_filter)
        require_choice(f"{name}.derivative_on", self.derivative_on, DERIVATIVE_ON)
        require_choice(f"{name}.integration", self.integration, INTEGRATION)
        require_choice(f"{name}.anti_windup", self.anti_windup, ANTI_WINDUP)
        require_positive(f"{name}.tracking_time", self.tracking_time)
        require_finite(f"{name}.bias", self.bias)
        require(
            self.u_min < self.u_max,
            f"{name}.u_min, u_max",
            "u_min below u_max",
            (self.u_min, self.u_max),
        )

    def law_parameters(self, sample_time: float, ki_tracking: float) -> Array:
        """p[0:N_LAW]; `ki_tracking` is the K_i of back-calculation, the largest in magnitude."""
        name = type(self).__name__
        require_positive(f"{name}.block: sample_time", sample_time)
        slow = self.anti_windup != "back_calculation" or self.tracking_time >= sample_time
        expected = f"not below the sample time {sample_time:g} s"
        require(slow, f"{name}.tracking_time", expected, self.tracking_time)
        filtered = self.derivative_filter > 0.0
        alpha = math.exp(-sample_time / self.derivative_filter) if filtered else 0.0
        k_t = 1.0 / (ki_tracking * self.tracking_time) if ki_tracking != 0.0 else 0.0
        return np.array(
            [
                sample_time,
                INTEGRATION[self.integration],
                alpha,
                DERIVATIVE_ON[self.derivative_on],
                self.u_min,
                self.u_max,
                self.bias,
                float(ANTI_WINDUP[self.anti_windup]),
                k_t,
            ]
        )

    def law_inputs(self) -> tuple[Signal, ...]:
        """The inputs of every PID: reference and measured."""
        return (
            Signal("reference", self.measured_unit, "set point"),
            Signal("measured", self.measured_unit, "measured plant output"),
        )

    def law_outputs(self) -> tuple[Signal, ...]:
        """The outputs of the law in the order of the Y_ constants."""
        u, e = self.output_unit, self.measured_unit
        return (
            Signal("u", u, "control, limited"),
            Signal("p_part", u, "K_p·e"),
            Signal("i_part", u, "K_i·∫e dt"),
            Signal("d_part", u, "K_d·de/dt, filtered"),
            Signal("error", e, "reference − measured"),
            Signal("saturated", "1", "1 at the upper limit, −1 at the lower, else 0"),
            Signal("kp", _ratio(u, e), "proportional gain in force"),
            Signal("ki", _ratio(u, e, "s"), "integral gain in force"),
            Signal(
                "kd", _ratio(u and ("s" if u == "1" else f"{u}.s"), e), "derivative gain in force"
            ),
        )


def _ratio(numerator: str, *denominators: str) -> str:
    """A unit string for numerator/(denominators), leaving out dimensionless ones; "" where one of
    them is not stated."""
    if not all((numerator, *denominators)):
        return ""
    below = [unit for unit in denominators if unit != "1"]
    if not below:
        return numerator
    return f"{numerator}/({'.'.join(below)})" if len(below) > 1 else f"{numerator}/{below[0]}"


@dataclass(frozen=True, kw_only=True)
class PID(PIDLaw):
    """PID with fixed gains.

    kp  proportional gain [output_unit/measured_unit]
    ki  integral gain     [output_unit/(measured_unit·s)]
    kd  derivative gain   [output_unit·s/measured_unit]
    """

    kp: float
    ki: float = 0.0
    kd: float = 0.0

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        super().__post_init__()
        for name in ("kp", "ki", "kd"):
            require_finite(f"PID.{name}", getattr(self, name))

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        law = self.law_parameters(sample_time, self.ki)
        tracking = self.anti_windup == "back_calculation"  # then k_t was calculated from K_i
        return Block(
            inputs=self.law_inputs(),
            outputs=self.law_outputs(),
            step=pid_step,
            parameters=np.concatenate([law, [self.kp, self.ki, self.kd]]),
            parameter_names=(*LAW_PARAMETER_NAMES, "kp", "ki", "kd"),
            state=np.zeros(N_LAW_STATE),
            state_names=LAW_STATE_NAMES,
            tunable=(*LAW_TUNABLE, "kp", "kd", *(() if tracking else ("ki",))),
        )
