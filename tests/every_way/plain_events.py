"""Inputs, clocks and events of a run by the plain driver; what all kinds of interfaces share.

Inputs are staircases that change at communication points. Times are whole nanoseconds; those of the
events of a solver or of an early return are what they are.
"""

import ctypes as c
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.every_way.plain_fmu import EventInfo1, EventInfo2, PlainFmu

SECOND = 1_000_000_000
Steps = tuple[tuple[int, Any], ...]
"""Pairs of a time (ns) and the value from then on, the first one at 0."""


@dataclass(frozen=True)
class Job:
    """What is to be run; `watched` are names of variables, `triggers` times (ns) of clocks.

    A clock is triggered before the row of its instant, or with the inputs behind it (`wired`)."""

    path: Path
    kind: str
    step_ns: int
    steps: int
    watched: tuple[str, ...]
    inputs: dict[str, Steps] = field(default_factory=dict)
    start_values: dict[str, Any] = field(default_factory=dict)
    event_mode: bool = False
    triggers: dict[str, tuple[int, ...]] = field(default_factory=dict)
    wired: bool = False


class Events:
    """A run so far; `rows[name]` are the values of a watched variable."""

    def __init__(self, job: Job, fmu: PlainFmu) -> None:
        self.job, self.fmu = job, fmu
        self.rows: dict[str, list[Any]] = {name: [] for name in job.watched}
        self.pending: dict[str, int] = {}
        self.ticked: dict[str, int] = {}
        self.next_event = math.inf
        self.begun = -1  # the communication point whose step has begun (ns)
        self.clocks = {n: v for n, v in fmu.variables.items()
                       if v.type == "Clock" and v.causality == "input"}  # fmt: skip

    def row(self) -> None:
        for name, values in self.rows.items():
            values.append(self.fmu.get(name))

    def changes(self, ns: int) -> dict[str, Any]:
        """The inputs that change at `ns`, with their values."""
        return {name: value for name, steps in self.job.inputs.items()
                for time, value in steps if time == ns}  # fmt: skip

    def begins(self, ns: int) -> bool:
        """Whether the step that begins at `ns` begins with an event."""
        self.begun = ns
        return bool(self.changes(ns)) or (self.job.wired and bool(self.due(ns)))

    def set_inputs(self, ns: int) -> None:
        for name, value in self.changes(ns).items():
            self.fmu.set(name, value)

    # clocks

    def due(self, ns: int) -> list[str]:
        """The clocks that tick at `ns` and have not yet, by priority."""
        found = []
        for name, v in self.clocks.items():
            a = v.attributes
            if a["intervalVariability"] == "constant":
                if "intervalDecimal" in a:
                    period = round(float(a["intervalDecimal"]) * SECOND)
                else:
                    period = int(a["intervalCounter"]) * SECOND // int(a["resolution"])
                ticks = ns % period == 0
            else:
                triggered = ns in self.job.triggers.get(name, ())
                triggered = triggered and (not self.job.wired or self.begun == ns)
                ticks = triggered or self.pending.get(name) == ns
            if ticks and self.ticked.get(name) != ns:
                found.append(name)
        return sorted(found, key=lambda n: int(self.clocks[n].attributes.get("priority", 0)))

    def tick(self, names: list[str], ns: int) -> None:
        for name in names:
            self.ticked[name] = ns
            self.pending.pop(name, None)
            if self.job.kind != "scheduled-execution":
                self.fmu.set(name, True)

    def count_down(self, ns: int) -> None:
        for name, v in self.clocks.items():
            if v.attributes["intervalVariability"] == "countdown":
                seconds, qualifier = c.c_double(), c.c_int()
                one = (c.c_uint32 * 1)(v.reference)
                self.fmu.call("GetIntervalDecimal", one, c.c_size_t(1), c.byref(seconds),
                              c.byref(qualifier))  # fmt: skip
                if qualifier.value == 2:
                    self.pending[name] = ns + round(seconds.value * SECOND)

    # events

    def handle(self, time: float, enter: bool = True) -> None:
        """An event at `time` (s), with iteration; the FMU is left in event mode's successor."""
        ns = round(time * SECOND)
        if enter and self.fmu.version != "1":
            self.fmu.call("EnterEventMode")
        if time == ns / SECOND:
            self.set_inputs(ns)
        again = True
        while again:
            ticking = self.due(ns) if time == ns / SECOND else []
            self.tick(ticking, ns)
            again = self._update()
            self.count_down(ns)
            again = again or bool(self.due(ns) if time == ns / SECOND else [])
        if self.fmu.version != "1":
            stepping = self.job.kind == "co-simulation"
            self.fmu.call("EnterStepMode" if stepping else "EnterContinuousTimeMode")

    def _update(self) -> bool:
        fmu = self.fmu
        if fmu.version == "1":
            info = EventInfo1()
            fmu.call("EventUpdate", c.c_char(0), c.byref(info))
            return self._told(not ord(info.converged), bool(ord(info.upcoming)), info.next)
        if fmu.version == "2":
            two = EventInfo2()
            fmu.call("NewDiscreteStates", c.byref(two))
            return self._told(bool(two.needs), bool(two.defined), two.next)
        flags, next_ = [c.c_bool() for _ in range(5)], c.c_double()
        fmu.call("UpdateDiscreteStates", *map(c.byref, flags), c.byref(next_))
        return self._told(flags[0].value, flags[4].value, next_.value)

    def _told(self, again: bool, defined: bool, time: float) -> bool:
        self.next_event = time if defined else math.inf
        return again
