"""Signals made of other signals, or of a Python function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import SeedSequence

from harness.clock import nearest_nanosecond
from harness.errors import ExperimentError, SimulationError
from harness.instruments.checks import check_numbers, check_signal, check_time, check_unit, label
from harness.instruments.source import (
    PureSampler,
    Sampler,
    SignalSource,
    Times,
    Values,
    child_seed,
)


@dataclass(frozen=True)
class Function:
    """A Python function of time: `function(t)`, t in seconds, gives a number. For library use."""

    kind: ClassVar[str] = "function"
    function: Callable[[float], float]
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        if not callable(self.function):
            raise ExperimentError(
                f"{label(self)}: 'function' must be a Python callable, got {self.function!r}; "
                "in an experiment file take another kind, such as 'csv'"
            )
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Calls the function once an instant; its exception becomes a `SimulationError`."""

        def values(times_ns: Times) -> Values:
            sampled = np.empty(len(times_ns))
            for index, instant in enumerate(times_ns.tolist()):
                try:
                    sampled[index] = self.function(instant / 1e9)
                except Exception as fault:
                    raise SimulationError(
                        f"signal function {self.function!r} failed at t = {instant / 1e9:g} s: "
                        f"{type(fault).__name__}: {fault}"
                    ) from fault
            return sampled

        return PureSampler(values)


@dataclass(frozen=True)
class SumSampler:
    """Adds what its parts give, in their order."""

    parts: tuple[Sampler, ...]

    def sample(self, times_ns: Times) -> Values:
        """The sum of the parts at each instant."""
        total = np.zeros(len(times_ns))
        for part in self.parts:
            total += part.sample(times_ns)
        return total


@dataclass(frozen=True)
class Sum:
    """The sum of `signals`; each has a random stream of its own. Units that the parts state must
    be the same."""

    kind: ClassVar[str] = "sum"
    signals: tuple[SignalSource, ...]
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        if not isinstance(self.signals, tuple) or not self.signals:
            raise ExperimentError(
                f"{label(self)}: 'signals' must hold at least one signal, got {self.signals!r}"
            )
        for one in self.signals:
            check_signal(self, one)
        check_unit(self)
        units = {one.unit for one in (self, *self.signals) if one.unit is not None}
        if len(units) > 1:
            raise ExperimentError(
                f"{label(self)}: its signals must have one unit, got {', '.join(sorted(units))}"
            )
        if self.unit is None and units:
            object.__setattr__(self, "unit", units.pop())

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Part i is seeded with child i of `seed`."""
        return SumSampler(
            tuple(one.sampler(child_seed(seed, i)) for i, one in enumerate(self.signals))
        )


@dataclass(frozen=True)
class AffineSampler:
    """gain·s + offset."""

    part: Sampler
    gain: float
    offset: float

    def sample(self, times_ns: Times) -> Values:
        """The scaled values."""
        return self.gain * self.part.sample(times_ns) + self.offset


@dataclass(frozen=True)
class Scaled:
    """gain·s(t) + offset, for a signal s; `unit` is that of the result."""

    kind: ClassVar[str] = "scaled"
    signal: SignalSource
    gain: float = 1.0
    offset: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_signal(self, self.signal)
        check_numbers(self, "gain", "offset")
        check_unit(self)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """The signal is seeded with `seed` itself."""
        return AffineSampler(self.signal.sampler(seed), float(self.gain), float(self.offset))


@dataclass(frozen=True)
class WindowedSampler:
    """The part's values inside the window, `outside` elsewhere; the part is sampled throughout."""

    part: Sampler
    start: int
    end: int | None
    outside: float

    def sample(self, times_ns: Times) -> Values:
        """The gated values."""
        inside = times_ns >= self.start
        if self.end is not None:
            inside &= times_ns < self.end
        return np.where(inside, self.part.sample(times_ns), self.outside)


@dataclass(frozen=True)
class Windowed:
    """A signal from `start_time` (s) until before `end_time` (never where None), else `outside`.

    The signal runs all the time: opening the window later leaves its random values as they were.
    """

    kind: ClassVar[str] = "windowed"
    signal: SignalSource
    start_time: float = 0.0
    end_time: float | None = None
    outside: float = 0.0
    unit: str | None = None

    def __post_init__(self) -> None:
        """Checks every field."""
        check_signal(self, self.signal)
        check_numbers(self, "outside")
        check_time(self, "start_time")
        if self.end_time is not None:
            check_time(self, "end_time")
        check_unit(self)
        if self.unit is None:
            object.__setattr__(self, "unit", self.signal.unit)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """The signal is seeded with `seed` itself."""
        end = None if self.end_time is None else nearest_nanosecond(self.end_time)
        start = nearest_nanosecond(self.start_time)
        return WindowedSampler(self.signal.sampler(seed), start, end, float(self.outside))
