"""Inputs over time, for inputs and tunable parameters: what holds when, and when it jumps.

A continuous input (of a floating type) is interpolated linearly between its rows; everything else
is held. Where a time repeats, the first row holds before it and the last one after it: that is a
discontinuity, and so is every change of a value that is held. Before the first row the first one
holds, after the last row the last one. Functions of time are called with the time in seconds; a
jump of theirs is seen at the next communication point or recorded row, not before.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from harness.errors import SimulationError
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.values import flat
from harness.fmi.description.model_description import REAL_TYPES, Variable

Function = Callable[[float], Any]


@dataclass(frozen=True)
class Track:
    """The values of one variable over time: rows at `times` (s, not decreasing), or a function."""

    variable: Variable
    times: tuple[float, ...] = ()
    rows: tuple[tuple[Any, ...], ...] = ()
    function: Function | None = None

    @property
    def continuous(self) -> bool:
        """Whether the values are interpolated and may be set at any time."""
        return self.variable.type in REAL_TYPES and self.variable.variability == "continuous"

    def before(self, time: float) -> Sequence[Any]:
        """The values just before `time`."""
        return self._at(time, bisect_left(self.times, time))

    def after(self, time: float) -> Sequence[Any]:
        """The values at `time` and just after it."""
        return self._at(time, bisect_right(self.times, time))

    def _at(self, time: float, upper: int) -> Sequence[Any]:
        if self.function is not None:
            return self._computed(self.function, time)
        if upper == 0:  # a row at this very time is reached from the left
            return self.rows[0]
        if upper == len(self.times) or not self.continuous:
            return self.rows[upper - 1]
        left, right = self.times[upper - 1], self.times[upper]
        if right == left:
            return self.rows[upper]
        share = (time - left) / (right - left)
        pairs = zip(self.rows[upper - 1], self.rows[upper], strict=True)
        return [a if share == 0.0 else b if share == 1.0 else a + share * (b - a) for a, b in pairs]

    def _computed(self, function: Function, time: float) -> Sequence[Any]:
        try:
            return flat(function(time))
        except Exception as fault:
            name = self.variable.name
            raise SimulationError(
                f"the function of input {name!r} failed at t = {time:.9g} s: {fault!r}"
            ) from fault

    def events(self) -> set[float]:
        """Times of discontinuities."""
        pairs = zip(self.times[:-1], self.times[1:], self.rows[:-1], self.rows[1:], strict=True)
        if self.continuous:
            return {t1 for t0, t1, row0, row1 in pairs if t0 == t1 and row0 != row1}
        return {t1 for _, t1, row0, row1 in pairs if row0 != row1}

    def kinks(self) -> set[float]:
        """Times between which the values are smooth."""
        return set(self.times) if self.continuous and len(self.times) > 1 else set()


def first_after(times: Sequence[float], time: float) -> float:
    """The first of some ascending times that is later than `time`, or infinity."""
    i = bisect_right(times, time)
    return times[i] if i < len(times) else math.inf


class Inputs:
    """All tracks of a simulation; `next_event` and `next_kink` look ahead."""

    def __init__(self, tracks: Sequence[Track] = ()) -> None:
        """Sort the tracks into continuous ones, held ones and clocks."""
        self.clocks = {t.variable.name: t for t in tracks if t.variable.type == "Clock"}
        values = [t for t in tracks if t.variable.type != "Clock"]
        self.continuous = [t for t in values if t.continuous]
        self.held = [t for t in values if not t.continuous]
        self._events = sorted(set().union(*(t.events() for t in values)) if values else ())
        kinks = set(self._events).union(*(t.kinks() for t in values))
        self._kinks = sorted(kinks)
        self._written: dict[str, Any] = {}

    @property
    def has_held_functions(self) -> bool:
        """Whether a value that jumps is computed by a function, so that its jumps are not known."""
        return any(t.function is not None for t in self.held)

    def jumped(self, time: float) -> bool:
        """Whether a function now gives another value than was set for what is held."""
        computed = [t for t in self.held if t.function is not None]
        return any(self._written.get(t.variable.name) != t.after(time) for t in computed)

    def next_event(self, time: float) -> float:
        """The first discontinuity later than `time` (s), or infinity."""
        return first_after(self._events, time)

    def next_kink(self, time: float) -> float:
        """The first discontinuity of the values or their slopes later than `time`, or infinity."""
        return first_after(self._kinks, time)

    def apply_continuous(self, instance: FmuInstance, time: float, *, after: bool) -> None:
        """Set the continuous inputs to their values just after `time`, or just before it."""
        if self.continuous:
            instance.set(self._taken(self.continuous, time, after))

    def apply(self, instance: FmuInstance, time: float) -> None:
        """Set everything that is not yet as it should be at `time`."""
        if self.continuous or self.held:
            instance.set(self.changed(time))

    def changed(self, time: float) -> dict[str, Any]:
        """The inputs that are not yet as they should be at `time`; they are taken as set."""
        return self._taken((*self.continuous, *self.held), time, True)

    def _taken(self, tracks: Iterable[Track], time: float, after: bool) -> dict[str, Any]:
        found = {}
        for track in tracks:
            name = track.variable.name
            values = track.after(time) if after else track.before(time)
            if self._written.get(name) != values:
                self._written[name] = values
                scalar = not track.variable.dimensions and len(values) == 1
                found[name] = values[0] if scalar else list(values)
        return found

    def forget(self) -> None:
        """What was set is no longer known, as after a return to an earlier state."""
        self._written.clear()
