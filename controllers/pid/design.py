"""PID gains by stated rules, from an ultimate point or from a process model.

Design is separate from running: a rule returns a record, whose gains the controller only applies.

    ziegler_nichols   Ziegler & Nichols 1942, from ultimate gain and period
    simc_integrating  Skogestad 2003 (SIMC), for k'·exp(−θs)/(s·(τ_2·s + 1))
    simc_first_order  Skogestad 2003 (SIMC), for k·exp(−θs)/((τ_1·s + 1)·(τ_2·s + 1))
    ultimate_point    ultimate gain and period of a sampled linear model

A controller sampled at T and held adds about T/2 to the delay θ of a continuous-time model: the
caller includes it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from controllers.core.block import Array
from controllers.core.errors import (
    ControllerError,
    require,
    require_choice,
    require_not_negative,
    require_positive,
)


@dataclass(frozen=True)
class PIDGains:
    """Gains of the parallel form (1) and the rule that gave them."""

    kp: float
    ki: float
    kd: float
    rule: str


# K_p/K_u, T_i/T_u, T_d/T_u; without integral T_i is infinite.
_ZIEGLER_NICHOLS = {
    "P": (0.5, math.inf, 0.0),
    "PI": (0.45, 1.0 / 1.2, 0.0),
    "PID": (0.6, 0.5, 0.125),
}


def ziegler_nichols(ultimate_gain: float, ultimate_period: float, kind: str = "PID") -> PIDGains:
    """Ziegler–Nichols gains from K_u [u/y] and T_u [s]; kind "P", "PI" or "PID"."""
    require_positive("ziegler_nichols: ultimate_gain", ultimate_gain)
    require_positive("ziegler_nichols: ultimate_period", ultimate_period)
    require_choice("ziegler_nichols: kind", kind, _ZIEGLER_NICHOLS)
    gain, integral, derivative = _ZIEGLER_NICHOLS[kind]
    kp = gain * ultimate_gain
    return PIDGains(
        kp=kp,
        ki=kp / (integral * ultimate_period),
        kd=kp * derivative * ultimate_period,
        rule=f"Ziegler-Nichols {kind}, K_u = {ultimate_gain:g}, T_u = {ultimate_period:g} s",
    )


def _parallel(kc: float, ti: float, td: float, rule: str) -> PIDGains:
    """Parallel form of the series form K_c·(1 + 1/(T_i·s))·(1 + T_d·s)."""
    return PIDGains(kp=kc * (1.0 + td / ti), ki=kc / ti, kd=kc * td, rule=rule)


def simc_integrating(
    slope: float, delay: float, lag: float = 0.0, closed_loop_time: float | None = None
) -> PIDGains:
    """SIMC for an integrating process: slope k' [y/(u·s)], delay θ [s], lag τ_2 [s].

    `closed_loop_time` τ_c [s] defaults to θ, the tight tuning. With a lag the result is a PID.
    """
    require_positive("simc_integrating: slope", slope)
    require_positive("simc_integrating: delay", delay)
    require_not_negative("simc_integrating: lag", lag)
    tau_c = delay if closed_loop_time is None else closed_loop_time
    require_positive("simc_integrating: closed_loop_time", tau_c)
    kc = 1.0 / (slope * (tau_c + delay))
    rule = f"SIMC integrating, k' = {slope:g}, θ = {delay:g} s, τ_2 = {lag:g} s, τ_c = {tau_c:g} s"
    return _parallel(kc, 4.0 * (tau_c + delay), lag, rule)


def simc_first_order(
    gain: float,
    time_constant: float,
    delay: float,
    lag: float = 0.0,
    closed_loop_time: float | None = None,
) -> PIDGains:
    """SIMC for a first-order process: gain k [y/u], τ_1 [s], delay θ [s], second lag τ_2 [s]."""
    require_positive("simc_first_order: gain", gain)
    require_positive("simc_first_order: time_constant", time_constant)
    require_positive("simc_first_order: delay", delay)
    require_not_negative("simc_first_order: lag", lag)
    tau_c = delay if closed_loop_time is None else closed_loop_time
    require_positive("simc_first_order: closed_loop_time", tau_c)
    kc = time_constant / (gain * (tau_c + delay))
    ti = min(time_constant, 4.0 * (tau_c + delay))
    rule = f"SIMC first order, k = {gain:g}, τ_1 = {time_constant:g} s, θ = {delay:g} s"
    return _parallel(kc, ti, lag, rule)


@dataclass(frozen=True)
class UltimatePoint:
    """Smallest proportional gain at which the sampled loop oscillates, and that period [s]."""

    gain: float
    period: float


def ultimate_point(
    A: Array, b: Array, c: Array, sample_time: float, largest_gain: float = 1e9
) -> UltimatePoint:
    """Ultimate point of x⁺ = A·x + b·u, y = c·x under u = −K·y, for K > 0.

    The loop must be stable for small K. Raises `ControllerError` where it is not, or stays
    stable up to `largest_gain`.
    """
    require_positive("ultimate_point: sample_time", sample_time)
    column, row = np.reshape(b, (-1, 1)), np.reshape(c, (1, -1))
    require(A.shape == (len(column), row.shape[1]), "ultimate_point: A", "a square A", A.shape)

    def excess(gain: float) -> float:
        return float(np.max(np.abs(np.linalg.eigvals(A - gain * column @ row)))) - 1.0

    gains = largest_gain * np.logspace(-18, 0, 721)
    stable = np.array([excess(gain) < 0.0 for gain in gains])
    if not stable.any():
        raise ControllerError("ultimate_point: expected a loop stable for small gains of u = −K·y.")
    first = int(np.argmax(stable))
    unstable = np.flatnonzero(~stable[first:])
    if not len(unstable):
        raise ControllerError(f"ultimate_point: the loop is stable up to gain {largest_gain:g}.")
    edge = first + int(unstable[0])
    gain = float(brentq(excess, gains[edge - 1], gains[edge], rtol=1e-14))
    poles = np.linalg.eigvals(A - gain * column @ row)
    angle = float(np.max(np.abs(np.angle(poles[np.abs(poles) > 1.0 - 1e-6]))))
    period = 2.0 * math.pi * sample_time / angle if angle > 0.0 else math.inf
    return UltimatePoint(gain, period)
