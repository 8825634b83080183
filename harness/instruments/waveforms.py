"""Deterministic signals of time. Edges are compared in integer nanoseconds: at an edge's own
instant the new value holds, however the instant is written in seconds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Annotated

import numpy as np

from harness.clock import nearest_nanosecond, seconds_of
from harness.errors import ExperimentError
from harness.instruments.checks import (
    Duration,
    NotNegative,
    Number,
    Numbers,
    Time,
    Waveform,
    check_choice,
    check_number,
    check_one_of,
    check_order,
    label,
    require,
)
from harness.instruments.source import Times, Values

TWO_PI = 2.0 * math.pi
OpenShare = Annotated[float, partial(check_number, above=0.0, below=1.0)]
Sweep = Annotated[str, partial(check_choice, legal=("linear", "logarithmic"))]


@dataclass(frozen=True)
class Constant(Waveform, kind="constant"):
    """The same `value` at every instant."""

    value: Number

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        return np.full(len(times_ns), float(self.value))


@dataclass(frozen=True)
class Step(Waveform, kind="step"):
    """`initial` before `time` (s), `final` at it and after."""

    final: Number
    time: Time = 0.0
    initial: Number = 0.0

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        edge = nearest_nanosecond(self.time)
        return np.where(times_ns >= edge, float(self.final), float(self.initial))


@dataclass(frozen=True)
class MultiStep(Waveform, kind="multi_step"):
    """`values[i]` from `times[i]` (s) on, `initial` before the first of them."""

    times: Numbers
    values: Numbers
    initial: Number = 0.0

    def _settle(self) -> None:
        if len(self.times) != len(self.values) or not self.times:
            raise ExperimentError(
                f"{label(self)}: 'times' and 'values' must be of one length, at least 1, got "
                f"{len(self.times)} and {len(self.values)}"
            )
        rising = bool(np.all(np.diff(self._edges) > 0))
        require(self, "times", rising, "increase by at least 1 ns")

    @cached_property
    def _edges(self) -> Times:
        return np.array(list(map(nearest_nanosecond, self.times)), dtype=np.int64)

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        levels = np.array([self.initial, *self.values], dtype=np.float64)
        return levels[np.searchsorted(self._edges, times_ns, "right")]


@dataclass(frozen=True)
class Ramp(Waveform, kind="ramp"):
    """`initial` until `start_time` (s), then rising by `slope` a second, held from `end_time` on
    where one is given."""

    slope: Number
    start_time: Time = 0.0
    end_time: Time | None = None
    initial: Number = 0.0

    def _settle(self) -> None:
        check_order(self, "start_time", "end_time")

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        start = nearest_nanosecond(self.start_time)
        end = None if self.end_time is None else nearest_nanosecond(self.end_time)
        elapsed = np.clip(times_ns, start, end) - start
        return self.initial + self.slope * seconds_of(elapsed)


@dataclass(frozen=True)
class Sine(Waveform, kind="sine"):
    """bias + amplitude·sin(2π·frequency·t + phase), phase in rad; the frequency is given either
    as `frequency` in Hz or as `angular_frequency` in rad/s."""

    amplitude: Number
    frequency: NotNegative | None = None
    angular_frequency: NotNegative | None = None
    phase: Number = 0.0
    bias: Number = 0.0

    def _settle(self) -> None:
        check_one_of(self, "frequency", "angular_frequency")

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        given = self.angular_frequency
        omega = TWO_PI * (self.frequency or 0.0) if given is None else given
        return self.bias + self.amplitude * np.sin(omega * seconds_of(times_ns) + self.phase)


@dataclass(frozen=True)
class Chirp(Waveform, kind="chirp"):
    """bias + amplitude·sin(φ(τ) + phase), τ = t − start_time, whose frequency φ'/2π goes from
    `start_frequency` f0 to `end_frequency` f1 (Hz) over `duration` T (s).

    linear:       φ = 2π (f0 τ + (f1 − f0) τ² / 2T)
    logarithmic:  φ = 2π f0 T / ln(f1/f0) · ((f1/f0)^(τ/T) − 1)

    Before `start_time` φ = 0; after T the frequency stays f1, without a jump in phase.
    """

    amplitude: Number
    start_frequency: NotNegative
    end_frequency: NotNegative
    duration: Duration
    sweep: Sweep = "linear"
    start_time: Time = 0.0
    phase: Number = 0.0
    bias: Number = 0.0

    def _settle(self) -> None:
        if self.sweep == "logarithmic":
            check_number(self, "start_frequency", above=0.0)
            check_number(self, "end_frequency", above=0.0)

    def angle(self, elapsed: Values) -> Values:
        """φ (rad) at `elapsed` seconds since `start_time`."""
        f0, f1, T = self.start_frequency, self.end_frequency, self.duration
        tau = np.clip(elapsed, 0.0, T)
        after = np.maximum(elapsed - T, 0.0)
        if self.sweep == "linear" or f0 == f1:
            cycles = f0 * tau + (f1 - f0) * tau**2 / (2.0 * T)
        else:
            rate = math.log(f1 / f0)
            cycles = f0 * T / rate * np.expm1(rate * tau / T)
        return TWO_PI * (cycles + f1 * after)

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        angle = self.angle(seconds_of(times_ns - nearest_nanosecond(self.start_time)))
        return self.bias + self.amplitude * np.sin(angle + self.phase)


@dataclass(frozen=True)
class Pulse(Waveform, kind="pulse"):
    """bias + amplitude for `width` seconds from `start_time` on, else bias; again every `period`
    seconds where one is given."""

    amplitude: Number
    width: Duration
    start_time: Time = 0.0
    period: Duration | None = None
    bias: Number = 0.0

    def _settle(self) -> None:
        check_order(self, "width", "period")

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        elapsed = times_ns - nearest_nanosecond(self.start_time)
        within = elapsed if self.period is None else elapsed % nearest_nanosecond(self.period)
        high = (elapsed >= 0) & (within < nearest_nanosecond(self.width))
        return np.where(high, float(self.bias + self.amplitude), float(self.bias))


@dataclass(frozen=True)
class Square(Waveform, kind="square"):
    """bias + amplitude for the first `duty` share of every `period` (s), bias − amplitude for
    the rest; bias before `start_time`. Both edges are rounded to whole nanoseconds."""

    amplitude: Number
    period: Duration
    duty: OpenShare = 0.5
    start_time: Time = 0.0
    bias: Number = 0.0

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        elapsed = times_ns - nearest_nanosecond(self.start_time)
        high = elapsed % nearest_nanosecond(self.period) < nearest_nanosecond(
            self.duty * self.period
        )
        waves = np.where(high, self.bias + self.amplitude, self.bias - self.amplitude)
        return np.where(elapsed >= 0, waves, float(self.bias))
