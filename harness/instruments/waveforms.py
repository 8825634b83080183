"""Deterministic signals of time. Edges are compared in integer nanoseconds: at an edge's own
instant the new value holds, however the instant is written in seconds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import numpy as np
from numpy.random import SeedSequence

from harness.clock import nearest_nanosecond, seconds_of
from harness.errors import ExperimentError
from harness.instruments.checks import (
    check_choice,
    check_number,
    check_numbers,
    check_one_of,
    check_time,
    check_unit,
    is_number,
    label,
)
from harness.instruments.source import (
    PureSampler,
    Sampler,
    Times,
    Values,
)

TWO_PI = 2.0 * math.pi


@dataclass(frozen=True)
class Constant:
    """The same `value` at every instant."""

    kind: ClassVar[str] = "constant"
    value: float
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "value")
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler without memory; the seed is not used."""
        return PureSampler(lambda times_ns: np.full(len(times_ns), float(self.value)))


@dataclass(frozen=True)
class Step:
    """`initial` before `time` (s), `final` at it and after."""

    kind: ClassVar[str] = "step"
    final: float
    time: float = 0.0
    initial: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_numbers(self, "final", "initial")
        check_time(self, "time")
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler without memory; the seed is not used."""
        edge = nearest_nanosecond(self.time)
        low, high = float(self.initial), float(self.final)
        return PureSampler(lambda times_ns: np.where(times_ns >= edge, high, low))


@dataclass(frozen=True)
class MultiStep:
    """`values[i]` from `times[i]` (s) on, `initial` before the first of them."""

    kind: ClassVar[str] = "multi_step"
    times: tuple[float, ...]
    values: tuple[float, ...]
    initial: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_number(self, "initial")
        check_unit(self)
        for name in ("times", "values"):
            given = getattr(self, name)
            if not isinstance(given, tuple) or not all(is_number(one) for one in given):
                raise ExperimentError(f"{label(self)}: {name!r} must hold numbers, got {given!r}")
        if len(self.times) != len(self.values) or not self.times:
            raise ExperimentError(
                f"{label(self)}: 'times' and 'values' must be of one length, at least 1, got "
                f"{len(self.times)} and {len(self.values)}"
            )
        edges = [nearest_nanosecond(one) for one in self.times]
        if any(later <= earlier for earlier, later in pairwise(edges)):
            raise ExperimentError(
                f"{label(self)}: 'times' must increase by at least 1 ns, got {self.times!r}"
            )

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler without memory; the seed is not used."""
        edges = np.array([nearest_nanosecond(one) for one in self.times], dtype=np.int64)
        levels = np.array([self.initial, *self.values], dtype=np.float64)
        return PureSampler(lambda times_ns: levels[np.searchsorted(edges, times_ns, "right")])


@dataclass(frozen=True)
class Ramp:
    """`initial` until `start_time` (s), then rising by `slope` a second, held from `end_time` on
    where one is given."""

    kind: ClassVar[str] = "ramp"
    slope: float
    start_time: float = 0.0
    end_time: float | None = None
    initial: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_numbers(self, "slope", "initial")
        check_time(self, "start_time")
        if self.end_time is not None:
            check_time(self, "end_time")
            if self.end_time < self.start_time:
                raise ExperimentError(
                    f"{label(self)}: 'end_time' must not be before 'start_time' "
                    f"{self.start_time!r}, got {self.end_time!r}"
                )
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler without memory; the seed is not used."""
        start = nearest_nanosecond(self.start_time)
        end = None if self.end_time is None else nearest_nanosecond(self.end_time)

        def values(times_ns: Times) -> Values:
            elapsed = np.clip(times_ns, start, end) - start
            return self.initial + self.slope * seconds_of(elapsed)

        return PureSampler(values)


@dataclass(frozen=True)
class Sine:
    """bias + amplitude·sin(2π·frequency·t + phase), phase in rad; the frequency is given either
    as `frequency` in Hz or as `angular_frequency` in rad/s."""

    kind: ClassVar[str] = "sine"
    amplitude: float
    frequency: float | None = None
    angular_frequency: float | None = None
    phase: float = 0.0
    bias: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_numbers(self, "amplitude", "phase", "bias")
        check_one_of(self, "frequency", "angular_frequency")
        given = "frequency" if self.frequency is not None else "angular_frequency"
        check_number(self, given, at_least=0.0)
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler without memory; the seed is not used."""
        omega = self.angular_frequency
        if omega is None:
            assert self.frequency is not None
            omega = TWO_PI * self.frequency

        def values(times_ns: Times) -> Values:
            return self.bias + self.amplitude * np.sin(omega * seconds_of(times_ns) + self.phase)

        return PureSampler(values)


@dataclass(frozen=True)
class Chirp:
    """bias + amplitude·sin(φ(τ) + phase), τ = t − start_time, whose frequency φ'/2π goes from
    `start_frequency` f0 to `end_frequency` f1 (Hz) over `duration` T (s).

    linear:       φ = 2π (f0 τ + (f1 − f0) τ² / 2T)
    logarithmic:  φ = 2π f0 T / ln(f1/f0) · ((f1/f0)^(τ/T) − 1)

    Before `start_time` φ = 0; after T the frequency stays f1, without a jump in phase.
    """

    kind: ClassVar[str] = "chirp"
    amplitude: float
    start_frequency: float
    end_frequency: float
    duration: float
    sweep: str = "linear"
    start_time: float = 0.0
    phase: float = 0.0
    bias: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_numbers(self, "amplitude", "phase", "bias")
        check_choice(self, "sweep", "linear", "logarithmic")
        for name in ("start_frequency", "end_frequency"):
            if self.sweep == "linear":
                check_number(self, name, at_least=0.0)
            else:
                check_number(self, name, above=0.0)
        check_time(self, "duration", positive=True)
        check_time(self, "start_time")
        check_unit(self)

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

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A sampler without memory; the seed is not used."""
        start = nearest_nanosecond(self.start_time)

        def values(times_ns: Times) -> Values:
            angle = self.angle(seconds_of(times_ns - start))
            return self.bias + self.amplitude * np.sin(angle + self.phase)

        return PureSampler(values)
