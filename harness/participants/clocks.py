"""When the input clocks of an FMI 3 FMU tick: periodic ones, changing ones, countdowns, and those
that the user triggers.

Periodic clocks (constant, fixed, tunable) tick at start + shift + k * interval, exactly; where the
file states no interval the FMU is asked. A changing clock is asked for its next interval at each
tick, a countdown after each event. This module refuses to guess: a time-based clock without an
interval never ticks, and a note says so.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction

from harness.errors import FmuError
from harness.fmi.binding.fmi3 import Fmi3Instance
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.description.model_description import ModelDescription
from harness.participants.grid import Grid, exact
from harness.participants.tracks import Track, first_after

_PERIODIC = ("constant", "fixed", "tunable", "calculated")


def has_input_clocks(d: ModelDescription) -> bool:
    """Whether the FMU waits for ticks of clocks."""
    return any(v.type == "Clock" and v.causality == "input" for v in d.variables.values())


class Clocks:
    """The ticks of all input clocks of an instance; `next` looks ahead, `due` says which tick."""

    def __init__(
        self, instance: FmuInstance, start: float, triggers: Mapping[str, Track], notes: list[str]
    ) -> None:
        """Find the clocks; intervals that the FMU computes are asked for by `begin`."""
        self.instance = instance
        self.start = start
        self.notes = notes
        d = instance.description
        clocks = [v for v in d.variables.values() if v.type == "Clock" and not v.details.alias_of]
        self.inputs = {v.name: v for v in clocks if v.causality == "input"}
        self.outputs = tuple(v.name for v in clocks if v.causality != "input")
        self._grids: dict[str, Grid] = {}
        self._pending: dict[str, float] = {}
        self._triggers = {
            name: sorted({t for t, row in zip(track.times, track.rows, strict=True) if row[0]})
            for name, track in triggers.items()
        }

    def begin(self) -> None:
        """Ask for the intervals that the file does not state; after initialisation."""
        for name, v in self.inputs.items():
            kind = v.details.interval_variability
            if kind in _PERIODIC:
                stated = seconds(v.details.interval)
                interval = self._ask(name) if stated is None else self._judged(name, stated)
                if interval:
                    first = exact(self.start) + (seconds(v.details.shift) or 0)
                    self._grids[name] = Grid(first, interval)
                else:
                    self.notes.append(f"clock {name!r} never ticks: its interval is not known")
            elif kind == "changing":
                self._pending[name] = self.start + float(seconds(v.details.shift) or 0)

    def _ask(self, name: str) -> Fraction | None:
        fmu = self.instance
        if not isinstance(fmu, Fmi3Instance) or not fmu.offers("GetIntervalDecimal"):
            return None
        interval = fmu.interval(name)
        return None if interval is None else self._judged(name, exact(interval))

    def _judged(self, name: str, interval: Fraction) -> Fraction:
        """An interval that time can go on by; a countdown may be of no time."""
        zero = self.inputs[name].details.interval_variability == "countdown"
        if interval > 0 or (zero and interval == 0):
            return interval
        raise FmuError(
            f"component {self.instance.name}: clock {name!r} has an interval of "
            f"{float(interval):g} s; expected {'0 s or more' if zero else 'more than 0 s'}"
        )

    def next(self, time: float) -> float:
        """The time (s) of the first tick later than `time`, or infinity."""
        ahead = [grid.after(time) for grid in self._grids.values()]
        ahead += [t for t in self._pending.values() if t > time]
        ahead += [first_after(times, time) for times in self._triggers.values()]
        return min(ahead, default=math.inf)

    def due(self, time: float) -> tuple[str, ...]:
        """The clocks that tick at `time`."""
        grids = self._grids.items()
        found = [name for name, grid in grids if grid.holds(time) and time >= float(grid.start)]
        found += [name for name, at in self._pending.items() if at == time]
        found += [name for name, times in self._triggers.items() if time in times]
        return tuple(sorted(found, key=list(self.inputs).index))

    def due_now(self, time: float) -> tuple[str, ...]:
        """The clocks that this very event started with a countdown of no time."""
        return tuple(name for name, at in self._pending.items() if at == time)

    def ticked(self, names: tuple[str, ...], time: float) -> None:
        """Plan the next ticks of clocks whose intervals change, after those of `names`."""
        for name in names:
            self._pending.pop(name, None)
            if self.inputs[name].details.interval_variability == "changing":
                self._plan(name, time)

    def memory(self) -> dict[str, float]:
        """The planned ticks (s) of clocks whose intervals change: all that is remembered."""
        return dict(self._pending)

    def recall(self, planned: Mapping[str, float]) -> None:
        """Return to what `memory` gave, as after a return of the FMU to an earlier state."""
        self._pending = dict(planned)

    def count_down(self, time: float) -> None:
        """Ask the countdown clocks whether they were started by the event at `time`."""
        for name, v in self.inputs.items():
            if v.details.interval_variability == "countdown":
                self._plan(name, time)

    def _plan(self, name: str, time: float) -> None:
        """The next tick, an interval after `time` (s), where the FMU gives one."""
        interval = self._ask(name)
        if interval is not None:
            self._pending[name] = float(exact(time) + interval)


def seconds(duration: tuple[int, int] | float | None) -> Fraction | None:
    """An interval or a shift as a file states it, (counter, resolution) or seconds, exactly."""
    if duration is None:
        return None
    if isinstance(duration, tuple):
        return Fraction(duration[0], duration[1])
    return exact(duration)
