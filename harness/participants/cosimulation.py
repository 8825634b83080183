"""Co-simulation of FMI 1, 2 and 3.

As a rule a step is one call of the FMU's doStep by address, with nothing of Python in it. Where
there is more to do, a callback does it: event mode and early return of FMI 3, clocks, inputs that
are functions of time, and steps that are divided because the FMU discards them. Then a
communication step is taken in parts, to the next event of inputs or clocks where the FMU takes
steps of any size, and both sides of an event become rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from harness.compiler import operations as op
from harness.errors import FmuError, SimulationError
from harness.fmi.binding.instance import FmuInstance, StepOutcome
from harness.fmi.binding.interface import CO_SIMULATION
from harness.participants import context as x
from harness.participants.attempt import Attempt
from harness.participants.clocks import has_input_clocks
from harness.participants.divided_steps import MOST_HALVINGS, Stepper
from harness.participants.driven import DrivenParticipant
from harness.participants.events import ENDED, FULL
from harness.participants.fmu import FmuParticipant
from harness.participants.grid import exact, is_close
from harness.participants.memory import Row
from harness.system.graph import Endpoint

_MOST_EVENTS_AT_ONCE = 1000
_NO_TICKS = "the FMU's clocks never tick: co-simulation is done without event mode"


class CoSimulation(DrivenParticipant):
    """An FMU that brings its own solver."""

    kind = CO_SIMULATION
    steps = True
    has_events = False
    _stepper: Stepper | None = None
    _attempt: Attempt | None = None

    def instantiate(self) -> FmuInstance:
        """With event mode where the FMU has it; some claim one that they do not have."""
        asked = self.component.policy.event_mode
        if asked is not False and self.capabilities.has_event_mode:
            try:
                instance = self.made(event_mode=True, early_return=True)
                self.has_events = True
                return instance
            except FmuError as refused:
                if asked:
                    raise
                without = f"co-simulation is done without event mode, since: {refused}"
                self.notes.append(without)
        elif has_input_clocks(self.description):
            self.notes.append(_NO_TICKS)
        return self.made()

    def enter_initialization(self, start: float, stop: float | None) -> None:
        """As any FMU; from here on it is known what a step takes."""
        super().enter_initialization(start, stop)
        timed = self.inputs.continuous or self.inputs.held
        divides = self.component.policy.discarded_steps == "divide"
        fixed = self.capabilities.fixed_internal_step_size
        if fixed and exact(self.seconds) % exact(fixed):
            self.notes.append(
                f"component {self.name}: its FMU computes in steps of {fixed:g} s, of which its "
                f"communication step of {self.seconds:g} s is no multiple"
            )
        self._direct = not (self.has_events or timed or divides)
        if not self._direct:
            self._stepper = Stepper(self.instance, self.notes, self.seconds, divides)
        self._tries = not (self._direct or self.has_events or timed)
        self._in_event, self._near, self._last, self._still = False, 0, float("nan"), 0
        self._flags = np.zeros(2, dtype=np.int64)
        self._given: dict[int, int] = {}
        self._continuous: dict[int, bool] = {}
        self._resume_at: float | None = None

    def leave_initialization(self, time: float) -> None:
        """Exit initialisation mode."""
        super().leave_initialization(time)
        if not self.has_events:
            self.clocks.inputs.clear()

    # rows

    def write(self, inputs: Sequence[str]) -> Iterator[Row]:
        """Set inputs: with event mode, discrete ones in an event, and only where they changed."""
        if not self.has_events:
            yield from super().write(inputs)
            return
        d = self.description
        rest: tuple[list[str], list[str]] = ([], [])
        for name in self.unclocked(inputs):
            steady = d.variable(d.owner(name)).variability == "continuous"
            rest[0 if steady else 1].append(name)
            for place in map(self.slot, d.scalars(name)):
                self._given.setdefault(place, -1)
                self._continuous[place] = steady
        yield self.calling(self._begin_write)
        for names, flag in zip(rest, (0, 8), strict=True):
            rows = list(super().write(names))
            yield [op.SKIP, int(self._flags.ctypes.data) + flag, 1 + len(rows)]
            yield from rows

    def step(self, ticks: int, final: bool) -> Iterator[Row]:
        """One doStep, or what does more."""
        if not self._direct:
            row = self.stepping(self._step, ticks)
            if self._tries and self._stepper is not None:
                tried = Attempt(self.instance, self._stepper, self.seconds, row[1])
                self._attempt = tried
                row = [op.STEP_CALL, tried.address, tried.context, ticks]
            yield row
            return
        head = [self.instance.address("DoStep"), self.instance.handle or 0, ticks]
        if self.instance.prefix != "fmi3":
            # FMI 1 is told that this is a new step, FMI 2 that the state before is not needed
            last = 1 if self.instance.prefix == "fmi" else int(final)
            yield [op.STEP_FMI2, *head, last]
            return
        flags = self.memory.held(np.zeros(3, dtype=np.uint8))
        last_time = self.memory.held(np.full(1, op.UNTOUCHED))
        yield [op.STEP_FMI3, *head, flags, last_time, int(final)]

    def save(self) -> Iterator[Row]:
        """Get the FMU state; plain co-simulation has nothing besides."""
        return FmuParticipant.save(self) if self._direct else super().save()

    def restore(self) -> Iterator[Row]:
        """Set the FMU state."""
        return FmuParticipant.restore(self) if self._direct else super().restore()

    def slopes(self, inputs: Sequence[str], slots: Sequence[int]) -> Iterator[Row]:
        """fmi2SetRealInputDerivatives of first order."""
        ends = [Endpoint(self.name, name) for name in inputs]
        orders = np.ones(len(ends), dtype=np.int32)
        head = [self.instance.address("SetRealInputDerivatives"), self.instance.handle or 0]
        references = self.memory.held(self.access.references(ends))
        values = self.memory.address(slots[0])
        yield [op.CALL_5, *head, references, len(ends), self.memory.held(orders), values]

    # steps in Python

    def advance(self, start: float, target: float) -> None:
        """The same step outside the loop; raises `HarnessError`."""
        if self._stepper is None:
            self._stepper = Stepper(self.instance, self.notes, self.seconds, False)
        self._step(0, start, target)

    def give(self, values: Mapping[str, Any]) -> None:
        """Set inputs at a communication point: discrete ones in an event, where there is one."""
        variables = self.description.variables
        discrete = any(variables[name].variability != "continuous" for name in values)
        if self.has_events and discrete:
            self.instance.enter_event_mode()
            self._in_event = True
        super().give(values)

    def remembered(self) -> dict[str, Any]:
        """What the importer must remember with a snapshot of the FMU."""
        return super().remembered() | {"in event mode": int(self._in_event)}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from where the FMU and `memory` come from."""
        super().recall(memory)
        self._in_event = bool(memory["in event mode"])
        self._resume_at = None
        self._given = dict.fromkeys(self._given, -1)

    def _step(self, unused: int, start: float, target: float) -> int:
        time = start if self._resume_at is None else self._resume_at
        self._resume_at = None
        self.hook.forget_ticks()
        while time < target:
            if self._room[0] < int(self.memory.clock[op.ROWS]) + 2:
                self._resume_at = time
                return FULL
            if self._in_event:
                self._handle(time)
            time = self._part(time, target)
        if self._attempt is not None:
            self._attempt.done()
        return 0

    def _part(self, time: float, target: float) -> float:
        """Step to the next communication point or event, and handle that; the time reached."""
        goal = target
        if self.capabilities.can_handle_variable_step:
            goal = min(target, self.hook.next_event(time))
        if self.has_events:
            self.inputs.apply_continuous(self.instance, time, after=True)
        else:
            self.inputs.apply(self.instance, time)
        assert self._stepper is not None
        if self._attempt is not None:
            self._attempt.hand_over()
        outcome, planned = self._stepper.advance(time, goal)
        if outcome.discarded:
            self._discarded(time, outcome)
        early = outcome.time < planned and not is_close(outcome.time, planned, planned - time)
        reached = outcome.time if early else planned
        self._judge(time, outcome.time, planned)
        if early and not self.instance.early_return:
            raise FmuError(
                f"component {self.name}: the step from t = {time:.9g} s to {planned:.9g} s ended "
                f"at {outcome.time:.9g} s, though no early return was allowed"
            )
        self._after(time, reached, target, outcome, early)
        return reached

    def _judge(self, time: float, reached: float, planned: float) -> None:
        """A step may not go back, nor stand still for ever."""
        self._still = self._still + 1 if reached == time else 0
        if reached < time or reached != reached:
            raise SimulationError(
                f"component {self.name}: the step from t = {time:.9g} s to {planned:.9g} s ended "
                f"at {reached:.9g} s, as the FMU says, which is not within the step"
            )
        if self._still > _MOST_EVENTS_AT_ONCE:
            raise SimulationError(
                f"component {self.name}: {self.words(x.CHATTERING, 0, f't = {time:.9g} s')}"
            )

    def _after(
        self, time: float, reached: float, target: float, outcome: StepOutcome, early: bool
    ) -> None:
        """Rows and events at the end of a part; the row at the communication point is the
        loop's."""
        jump = self.inputs.next_event(time) == reached
        event = self.has_events and (
            outcome.event_needed or self.hook.next_event(time) <= reached
            or self.inputs.jumped(reached)
        )  # fmt: skip
        if outcome.terminate or event or ((early or jump) and reached < target):
            self.hook.observe(reached)
        if outcome.terminate:
            raise self.ended(f" at t = {reached:.9g} s")
        if event:
            self.instance.enter_event_mode()
            self._in_event = True
            self._handle(reached)
            if reached < target:
                self.hook.observe(reached)

    def _handle(self, time: float) -> None:
        """Iterate the event at which the FMU is in event mode."""
        self._near = self._near + 1 if is_close(time, self._last, 1e-3) else 0
        self._last, self._in_event = time, False
        if self._near > _MOST_EVENTS_AT_ONCE:
            raise SimulationError(
                f"component {self.name}: {self.words(x.CHATTERING, 0, f't = {time:.9g} s')}"
            )
        self.hook.begin_event(time)
        status = self._settle(self.context.address, time)
        if status == ENDED:
            self.hook.observe(time)
        self.check(status)

    def _discarded(self, time: float, outcome: StepOutcome) -> None:
        if outcome.terminate:
            if outcome.time > time:
                self.hook.observe(outcome.time)
            raise self.ended(f" at t = {outcome.time:.9g} s")
        can = self.capabilities
        way_out = "the FMU cannot go back, so try a smaller --step-size"
        if can.can_handle_variable_step and can.can_get_and_set_fmu_state:
            way_out = f"so were {MOST_HALVINGS} smaller ones, each half as long as the one before"
        raise SimulationError(
            f"component {self.name}: the step at t = {time:.9g} s was discarded (computed up to "
            f"{outcome.time:.9g} s): {self.instance.log.reasons()}; {way_out}"
        )

    def _begin_write(self) -> None:
        """Which inputs have changed since they were set; discrete ones and clocks need an event."""
        wide, continuous = self.memory.wide, self._continuous
        self._flags[:] = 0
        for place, before in self._given.items():
            now = int(wide[place])
            if now != before:
                self._given[place] = now
                self._flags[0 if continuous[place] else 1] = 1
        v, started = self.memory.v, self.context.cells[x.UPDATE] != 0
        self.hook.triggered = tuple(n for n, at in self._triggers.items() if v[at] != 0.0)
        if (self._flags[1] or self.hook.triggered) and started and not self._in_event:
            self.instance.enter_event_mode()
            self._in_event = True

    def close(self) -> None:
        """Give the snapshot of divided steps back, too."""
        if self._stepper is not None:
            self._stepper.close()
        super().close()
