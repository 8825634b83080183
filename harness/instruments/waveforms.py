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
    Time,
    Waveform,
    check_choice,
    check_number,
    check_one_of,
    is_number,
    label,
)
from harness.instruments.source import Times, Values

TWO_PI = 2.0 * math.pi
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
        low, high = float(self.initial), float(self.final)
        return np.where(times_ns >= edge, high, low)


@dataclass(frozen=True)
class MultiStep(Waveform, kind="multi_step"):
    """`values[i]` from `times[i]` (s) on, `initial` before the first of them."""

    times: tuple[float, ...]
    values: tuple[float, ...]
    initial: Number = 0.0

    def __post_init__(self) -> None:
        """Checks every field."""
        super().__post_init__()
        for name in ("times", "values"):
            given = getattr(self, name)
            if not isinstance(given, tuple) or not all(map(is_number, given)):
                raise ExperimentError(f"{label(self)}: {name!r} must hold numbers, got {given!r}")
        if len(self.times) != len(self.values) or not self.times:
            raise ExperimentError(
                f"{label(self)}: 'times' and 'values' must be of one length, at least 1, got "
                f"{len(self.times)} and {len(self.values)}"
            )
        if np.any(np.diff(self._edges) <= 0):
            raise ExperimentError(
                f"{label(self)}: 'times' must increase by at least 1 ns, got {self.times!r}"
            )

    @cached_property
    def _edges(self) -> Times:
        return np.array(list(map(nearest_nanosecond, self.times)), dtype=np.int64)

    @cached_property
    def _levels(self) -> Values:
        return np.array([self.initial, *self.values], dtype=np.float64)

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        return self._levels[np.searchsorted(self._edges, times_ns, "right")]


@dataclass(frozen=True)
class Ramp(Waveform, kind="ramp"):
    """`initial` until `start_time` (s), then rising by `slope` a second, held from `end_time` on
    where one is given."""

    slope: Number
    start_time: Time = 0.0
    end_time: Time | None = None
    initial: Number = 0.0

    def __post_init__(self) -> None:
        """Checks every field."""
        super().__post_init__()
        if self.end_time is not None and self.end_time < self.start_time:
            raise ExperimentError(
                f"{label(self)}: 'end_time' must not be before 'start_time' "
                f"{self.start_time!r}, got {self.end_time!r}"
            )

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

    def __post_init__(self) -> None:
        """Checks every field."""
        super().__post_init__()
        check_one_of(self, "frequency", "angular_frequency")

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        omega = self.angular_frequency
        if omega is None:
            assert self.frequency is not None
            omega = TWO_PI * self.frequency
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

    def __post_init__(self) -> None:
        """Checks every field."""
        super().__post_init__()
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
        start = nearest_nanosecond(self.start_time)
        angle = self.angle(seconds_of(times_ns - start))
        return self.bias + self.amplitude * np.sin(angle + self.phase)
