"""What an FMU needs of Python inside of a step: inputs that are functions of time, clocks, and rows
at events.

Compiled kernels call it by address with what is wanted and the time; participants that step in
Python call the same methods. It raises nothing: a fault is remembered and a status returned.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from typing import Any, Protocol

from harness.fmi.binding.instance import FmuInstance
from harness.fmi.description.model_description import Variable
from harness.participants import context as x
from harness.participants.clocks import Clocks
from harness.participants.tracks import Inputs


class Owner(Protocol):
    """What the hook needs of its participant."""

    instance: FmuInstance

    def plan_ahead(self, event: float, kink: float) -> None:
        """The next event and the next kink (s) that the hook knows of."""

    def store(self, name: str, value: Any) -> None:
        """Store the value of a clocked variable for whoever reads it."""


class EventHook:
    """The inputs, clocks and event rows of one participant."""

    def __init__(self, owner: Owner, inputs: Inputs, clocks: Clocks) -> None:
        """`owner` stores values of clocked variables, and is told what comes next."""
        self.owner, self.instance = owner, owner.instance
        self.inputs, self.clocks = inputs, clocks
        self.fault: BaseException | None = None
        self.observer: Callable[[float], None] | None = None
        self.triggered: tuple[str, ...] = ()
        self._ticking: tuple[str, ...] | None = None
        self._held: list[Variable] = [
            v for v in owner.instance.description.variables.values()
            if (v.type == "Clock" or v.details.clocks) and v.causality != "input"
        ]  # fmt: skip
        self._ticked: set[str] = set()
        self.last_ticks: dict[str, float] = {}
        self._function = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64, ctypes.c_double)(self._call)
        self.address = ctypes.cast(self._function, ctypes.c_void_p).value or 0
        self.segment = -math.inf

    @property
    def wanted(self) -> int:
        """What compiled code must call it for."""
        found = x.BEFORE_EVENT | x.AFTER_EVENT if self.observer is not None else 0
        if self.inputs.continuous:
            found |= x.APPLY
        if self.inputs.continuous or self.inputs.held or self.clocks.inputs:
            found |= x.APPLY_AT_EVENT | x.PLAN
        if self.clocks.inputs or self.clocks.outputs:
            found |= x.APPLY_AT_EVENT | x.TICK | x.MORE_TICKS | x.PLAN | x.BEGIN
        if self.inputs.has_held_functions:
            found |= x.JUMPED
        return found

    def _call(self, what: int, time: float) -> int:
        try:
            match what:
                case x.APPLY:
                    after = time <= self.segment
                    self.inputs.apply_continuous(self.instance, time, after=after)
                case x.APPLY_AT_EVENT:
                    self.begin_event(time)
                case x.TICK:
                    self.tick(time)
                case x.MORE_TICKS:
                    return int(self.more_ticks(time))
                case x.PLAN:
                    self.segment = time
                    self.owner.plan_ahead(self.next_event(time), self.inputs.next_kink(time))
                case x.BEGIN:
                    self.forget_ticks()
                case x.JUMPED:
                    return int(self.inputs.jumped(time))
                case _:
                    self.observe(time)
        except BaseException as fault:
            self.fault = fault
            return x.FAULT
        return 0

    def next_event(self, time: float) -> float:
        """The first event (s) after `time` that comes from inputs or clocks."""
        return min(self.inputs.next_event(time), self.clocks.next(time))

    def begin_event(self, time: float) -> None:
        """The FMU is in event mode: inputs are set, and clocks will tick anew."""
        self._ticking = None
        self.inputs.apply(self.instance, time)

    def tick(self, time: float) -> None:
        """Set the clocks that tick in this iteration, and read what depends on them."""
        if self._ticking is None:
            due = [name for name in self.clocks.due(time) if self.last_ticks.get(name) != time]
            self.last_ticks |= dict.fromkeys(due, time)  # a second event at one time ticks no more
            self._ticking = (*due, *self.triggered)
            self.triggered = ()
        self.instance.set(dict.fromkeys(self._ticking, True))
        self._hold(self._ticking)
        self.clocks.ticked(self._ticking, time)

    def more_ticks(self, time: float) -> bool:
        """Whether this very iteration has started a countdown of no time."""
        self.clocks.count_down(time)
        before = self._ticking or ()
        self._ticking = tuple(name for name in self.clocks.due_now(time) if name not in before)
        return bool(self._ticking)

    def _hold(self, ticking: tuple[str, ...]) -> None:
        """Values of clocked variables last until their clock ticks again."""
        if not self._held:
            return
        active = dict.fromkeys(ticking, True)
        for name in self.clocks.outputs:
            active[name] = bool(self.instance.get(name))
        for name in self.clocks.inputs:
            active.setdefault(name, False)
        self.hold(active)

    def hold(self, active: dict[str, bool]) -> None:
        """Read what depends on the clocks that are `active`, and say which tick."""
        for v in self._held:
            if v.type == "Clock":
                if active.get(v.name, False):
                    self._ticked.add(v.name)
                    self.owner.store(v.name, True)
            elif any(active.get(clock, False) for clock in v.details.clocks):
                self.owner.store(v.name, self.instance.get(v.name))
        for name in active:
            if active[name] and name in self.clocks.inputs:
                self._ticked.add(name)
                self.owner.store(name, True)

    def forget_ticks(self) -> None:
        """A tick is one row."""
        for name in self._ticked:
            self.owner.store(name, False)
        self._ticked.clear()

    def observe(self, time: float) -> None:
        """Record a row at `time` (s)."""
        if self.observer is not None:
            self.observer(time)
            self.forget_ticks()
