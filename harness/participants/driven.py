"""What participants with events inside their steps have in common: the context of compiled code,
the hook into Python, and the words for what fails there."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from ctypes import c_double, c_int64
from typing import Any

import numpy as np

from harness.compiler import operations as op
from harness.errors import EndRequestedError, FmuError, SimulationError
from harness.fmi.binding.instance import FATAL
from harness.fmi.binding.values import flat, parse_value
from harness.participants import context as x
from harness.participants.clocks import Clocks
from harness.participants.context import Context
from harness.participants.events import ENDED, settle_entry
from harness.participants.fmu import FmuParticipant, Observer
from harness.participants.hook import EventHook
from harness.participants.memory import Memory, Row
from harness.participants.participant import Participant
from harness.participants.track_data import read_inputs
from harness.system.graph import Endpoint

_CALLS = {
    x.AT_SET_TIME: "SetTime",
    x.AT_SET_STATES: "SetContinuousStates",
    x.AT_GET_STATES: "GetContinuousStates",
    x.AT_DERIVATIVES: "Get(derivatives)",
    x.AT_INDICATORS: "GetEventIndicators",
    x.AT_NOMINALS: "GetNominalsOfContinuousStates",
    x.AT_COMPLETED: "CompletedIntegratorStep",
    x.AT_ENTER: "EnterEventMode",
    x.AT_UPDATE: "UpdateDiscreteStates",
    x.AT_LEAVE: "EnterContinuousTimeMode",
    x.AT_DIRECTIONAL: "GetDirectionalDerivative",
}
UPDATES = {1: "EventUpdate", 2: "NewDiscreteStates", 3: "UpdateDiscreteStates"}
"""The function that iterates the discrete states, by version of FMI."""
_MANY = 1000


def function_name(mark: int) -> str:
    """The function of FMI behind what compiled code has marked; "" for none."""
    version, what = divmod(mark, 32)
    if what not in _CALLS or version not in UPDATES:
        return ""
    name = UPDATES[version] if what == x.AT_UPDATE else _CALLS[what]
    if what == x.AT_DERIVATIVES:
        name = "GetContinuousStateDerivatives" if version == 3 else "GetDerivatives"
    return f"fmi{'' if version == 1 else version}{name}"


class DrivenParticipant(FmuParticipant):
    """An FMU whose steps are more than one call; `context` is what compiled code knows of it.

    `has_events`: it is in event mode after its initialisation; `steps`: it does steps of its own.
    """

    has_events = True
    steps = False

    def enter_initialization(self, start: float, stop: float | None) -> None:
        """Set start values, and inputs that are functions of time as they are at the start."""
        self._stop = math.inf if stop is None else stop
        self.context, told = Context(), self.around.told
        self._settle = settle_entry().ctypes
        self._room = self.context.array(x.ROOM, np.full(1, 2**62))
        self.context.array(x.INFO, np.zeros(16, dtype=np.int64))
        self.context.array(x.REACHED, told.reached)
        self.context.array(x.STOP_ASKED, told.stop_asked)
        self.context.array(x.FUNCTION, told.function)
        self.instance.tell_experiment(start, stop, self.tolerance)
        self.set_start_values()
        self.inputs = read_inputs(self.instance.description, self.component.inputs, self.notes)
        self.clocks = Clocks(self.instance, start, self.inputs.clocks, self.notes)
        self.hook = EventHook(self, self.inputs, self.clocks)
        self.instance.enter_initialization_mode(start, stop, self.tolerance)
        self.inputs.apply(self.instance, start)

    def link(self, memory: Memory, participants: Mapping[str, Participant]) -> None:
        """Values of clocked variables are their start values until the first tick."""
        super().link(memory, participants)
        self._triggers: dict[str, int] = {}
        self.context.cells[x.ROWS] = memory.clock.ctypes.data + 8 * op.ROWS
        for v in self.description.variables.values():
            if v.details.clocks and v.start and v.type != "Clock":
                starts = flat(parse_value(v, v.start, v.size))
                self.store(v.name, starts * v.size if len(starts) == 1 else starts)

    def leave_initialization(self, time: float) -> None:
        """Exit initialisation mode, and handle the event at the start where there are events."""
        super().leave_initialization(time)
        if not self.has_events:
            return
        self.clocks.begin()
        self.fill_events()
        if self.first_event():
            self.check(self._settle(self.context.address, time))
        self.hook.segment = time
        self.plan_ahead(self.hook.next_event(time), self.inputs.next_kink(time))

    def first_event(self) -> bool:
        """Whether the discrete states are to be iterated after initialisation."""
        return True

    def functions(self) -> dict[int, str]:
        """The functions of the FMU that compiled code calls, by their place in the context; ""
        where it does without."""
        modes = self.description.fmi_major > 1
        stepping = "EnterStepMode" if self.steps else "EnterContinuousTimeMode"
        return {
            x.UPDATE: UPDATES[self.description.fmi_major],
            x.ENTER_EVENTS: "EnterEventMode" if modes else "",
            x.LEAVE_EVENTS: stepping if modes else "",
        }

    def fill_events(self) -> None:
        """What compiled code knows of the FMU and its events."""
        c, d, instance = self.context, self.description, self.instance
        for place, name in self.functions().items():
            c.cells[place] = instance.address(name) if name else 0
        c.cells[x.HANDLE], c.cells[x.VERSION] = instance.handle or 0, d.fmi_major
        c.cells[x.HOOK], c.cells[x.WANTED] = self.hook.address, self.hook.wanted
        c.cells[x.IN_EVENT] = int(d.fmi_major > 1)
        for place in (x.EVENT_TIME, x.HOOK_TIME, x.KINK_TIME):
            c.reals[place] = math.inf
        c.reals[x.LAST_EVENT] = math.nan

    def unclocked(self, inputs: Sequence[str]) -> list[str]:
        """Inputs but clocks; of those it is remembered where what wires bring to them lies."""
        clocks = [name for name in inputs if self.description.port(name).type == "Clock"]
        self._triggers |= {name: self.slot(name) for name in clocks}
        return [name for name in inputs if name not in clocks]

    def look_for_triggers(self) -> None:
        """Find the clocks to which wires carry true."""
        v = self.memory.v
        self.hook.triggered = tuple(n for n, at in self._triggers.items() if v[at] != 0.0)

    # what the hook needs

    def plan_ahead(self, event: float, kink: float) -> None:
        """The next event and the next kink (s) that the hook knows of."""
        self.context.reals[x.HOOK_TIME], self.context.reals[x.KINK_TIME] = event, kink

    def store(self, name: str, value: Any) -> None:
        """Put the value of a clocked variable into its slots, where it has any."""
        for one, item in zip(self.description.scalars(name), flat(value), strict=True):
            end = Endpoint(self.name, one)
            if end in self.memory.layout.slots:
                self.memory.store(end, item)
                self.memory.store(end, item, "event")

    def observe(self, observer: Observer, room: int) -> None:
        """From now on `observer` records rows at events, of which there is `room` for some."""
        self.hook.observer = observer
        self._room[0] = room
        self.context.cells[x.WANTED] = self.hook.wanted

    @property
    def seconds(self) -> float:
        """The communication step (s)."""
        return self.component.step_ns / self.around.ticks_per_second

    # snapshots

    def save(self) -> Iterator[Row]:
        """Get the FMU state, and remember what the importer knows."""
        yield from super().save()
        yield self.calling(self._remember)

    def restore(self) -> Iterator[Row]:
        """Set the FMU state; inputs will be set anew."""
        yield from super().restore()
        yield self.calling(lambda: self.recall(self._snapshot))

    def _remember(self) -> None:
        self._snapshot = self.remembered()

    def calling(self, function: Callable[[], None]) -> Row:
        """A row that calls Python."""
        return [op.CALL_4, self.callback(function), 0, 0, 0, 0]

    def stepping(self, function: Callable[[int, float, float], int], ticks: int) -> Row:
        """A row that lets Python step by so many ticks: `function` of 0, start and end (s)."""
        return [op.STEP_CALL, self.callback(function, c_int64, c_double, c_double), 0, ticks]

    def callback(self, function: Callable[..., int | None], *types: Any) -> int:
        """The address of a C function that calls Python; a fault is remembered, and its status
        ends the run."""

        def call(*arguments: Any) -> int:
            try:
                return function(*arguments) or 0
            except BaseException as fault:
                self.fault = fault
                return ENDED if isinstance(fault, EndRequestedError) else x.FAULT

        return self.memory.function(call, *types)

    # outside of the loop

    @abstractmethod
    def advance(self, start: float, target: float) -> None:
        """The step of the loop from `start` to `target` (s); raises `HarnessError`."""

    def give(self, values: Mapping[str, Any]) -> None:
        """Set inputs at a communication point."""
        self.instance.set(values)

    def remembered(self) -> dict[str, Any]:
        """What the importer must remember with a snapshot of the FMU, as plain values."""
        cells, reals = self.context.cells, self.context.reals
        return {
            "next event": float(reals[x.EVENT_TIME]),
            "in event mode": int(cells[x.IN_EVENT]),
            "ticks": self.clocks.memory(),
            "last ticks": dict(self.hook.last_ticks),
        }

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from where the FMU and `memory` come from."""
        self.clocks.recall(memory["ticks"])
        self.hook.last_ticks = dict(memory["last ticks"])
        self.context.reals[x.EVENT_TIME] = memory["next event"]
        self.context.cells[x.IN_EVENT] = memory["in event mode"]

    # what a step came to

    def check(self, status: int) -> None:
        """Raise what a status of compiled code means."""
        if status != 0:
            fault = self.explained(status)
            assert fault is not None
            raise fault

    def explained(self, status: int) -> BaseException | None:
        """The fault behind a status of compiled code."""
        found = super().explained(status) or self.hook.fault
        if found is not None:
            return found
        if status == op.ASKED + op.TERMINATED:
            return self.ended()
        c = self.context
        what, code = int(c.cells[x.FAILED]), int(c.cells[x.STATUS])
        when = f"t = {float(c.reals[x.FAILED_AT]):.9g} s"
        if what == x.NOTHING:
            return None
        if what in _CALLS:
            name = UPDATES[self.description.fmi_major] if what == x.AT_UPDATE else _CALLS[what]
            if code == FATAL:
                self.instance.mark_dead()
            try:
                self.instance.check(code, name, f" at {when}")
            except FmuError as fault:
                return fault
        return SimulationError(f"component {self.name}: {self.words(what, code, when)}")

    def ended(self, when: str = "") -> EndRequestedError:
        """The FMU has asked for the end of the run."""
        reasons = self.instance.log.reasons()
        return EndRequestedError(
            f"component {self.name}: the FMU asked for the end of the run{when}: {reasons}"
        )

    def words(self, what: int, code: int, when: str) -> str:
        """What ended a step, apart from the functions of the FMU."""
        match what:
            case x.UNSETTLED:
                return f"the event at {when} does not settle in 1000 iterations of its states"
            case x.CHATTERING:
                return (
                    f"more than 1000 events at {when}, one after the other: the model chatters, "
                    "and time stands still"
                )
        return f"stopped at {when}"

    def terminate(self) -> None:
        """Terminate, and say so where many events have changed nothing."""
        super().terminate()
        idle = int(self.context.cells[x.UNCHANGED])
        if idle >= _MANY:
            of = int(self.context.cells[x.EVENTS])
            self.notes.append(f"{idle} of {of} events changed neither states nor derivatives")
