"""Signals made of other signals, or of a Python function."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.random import SeedSequence

from harness.clock import nearest_nanosecond
from harness.errors import ExperimentError, SimulationError
from harness.instruments.checks import Number, OneSignal, Signal, Signals, Time, label, require
from harness.instruments.source import (
    FunctionSampler,
    Sampler,
    Times,
    Values,
    child_seed,
)


@dataclass(frozen=True)
class Function(Signal, kind="function"):
    """A Python function of time: `function(t)`, t in seconds, gives a number. For library use."""

    function: Callable[[float], float]

    def _settle(self) -> None:
        hint = "; in an experiment file take another kind, such as 'csv'"
        require(self, "function", callable(self.function), "be a Python callable", hint)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Calls the function once an instant; its exception becomes a `SimulationError`."""

        def value(instant: int) -> float:
            try:
                return float(self.function(instant / 1e9))
            except Exception as fault:
                raise SimulationError(
                    f"signal function {self.function!r} failed at t = {instant / 1e9:g} s: "
                    f"{type(fault).__name__}: {fault}"
                ) from fault

        return FunctionSampler(lambda times_ns: np.array([*map(value, times_ns.tolist())], float))


@dataclass(frozen=True)
class Sum(Signal, kind="sum"):
    """The sum of `signals`; each has a random stream of its own. Units that the parts state must
    be the same."""

    signals: Signals

    def _settle(self) -> None:
        legal = isinstance(self.signals, tuple) and len(self.signals) > 0
        require(self, "signals", legal, "hold at least one signal")
        units = {one.unit for one in (self, *self.signals) if one.unit is not None}
        if len(units) > 1:
            raise ExperimentError(
                f"{label(self)}: its signals must have one unit, got {', '.join(sorted(units))}"
            )
        if self.unit is None and units:
            object.__setattr__(self, "unit", units.pop())

    def sampler(self, seed: SeedSequence) -> Sampler:
        """Adds what the parts give, in their order; part i is seeded with child i of `seed`."""
        parts = [one.sampler(child_seed(seed, i)) for i, one in enumerate(self.signals)]

        def total(times_ns: Times) -> Values:
            return sum((part.sample(times_ns) for part in parts), np.zeros(len(times_ns)))

        return FunctionSampler(total)


@dataclass(frozen=True)
class Scaled(Signal, kind="scaled"):
    """gain·s(t) + offset, for a signal s; `unit` is that of the result."""

    signal: OneSignal
    gain: Number = 1.0
    offset: Number = 0.0

    def sampler(self, seed: SeedSequence) -> Sampler:
        """The signal is seeded with `seed` itself."""
        part, gain, offset = self.signal.sampler(seed), float(self.gain), float(self.offset)
        return FunctionSampler(lambda times_ns: gain * part.sample(times_ns) + offset)


@dataclass(frozen=True)
class Windowed(Signal, kind="windowed"):
    """A signal from `start_time` (s) until before `end_time` (never where None), else `outside`.

    The signal runs all the time: opening the window later leaves its random values as they were.
    """

    signal: OneSignal
    start_time: Time = 0.0
    end_time: Time | None = None
    outside: Number = 0.0

    def _settle(self) -> None:
        if self.unit is None:
            object.__setattr__(self, "unit", self.signal.unit)

    def sampler(self, seed: SeedSequence) -> Sampler:
        """The signal is seeded with `seed` itself."""
        part, start = self.signal.sampler(seed), nearest_nanosecond(self.start_time)
        end = math.inf if self.end_time is None else nearest_nanosecond(self.end_time)

        def values(times_ns: Times) -> Values:
            inside = (times_ns >= start) & (times_ns < end)
            return np.where(inside, part.sample(times_ns), float(self.outside))

        return FunctionSampler(values)
