"""Stepping one FMU in co-simulation: FMI 1, 2 and 3, with event mode and early return.

At each communication point the inputs of that time are set, the FMU steps, and its outputs are
read. Communication points are those of the step size, of the output interval, of input events and
clock ticks where the FMU takes steps of any size. In event mode both sides of an event are
recorded: its time repeats. Steps that the FMU discards are divided (`retry`).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

from harness.errors import FmuError, SimulationError
from harness.fmi.binding.instance import FmuInstance, StepOutcome
from harness.participants.grid import Grid, is_close
from harness.simulation.clocks import Clocks
from harness.simulation.events import EventHandler
from harness.simulation.inputs import Inputs
from harness.simulation.outputs import Recorder
from harness.simulation.retry import MOST_HALVINGS, Stepper
from harness.simulation.settings import Settings


@dataclass
class CoSimulation:
    """One run; `run` yields the time (s) after initialisation and after each step."""

    instance: FmuInstance
    settings: Settings
    inputs: Inputs
    clocks: Clocks
    recorder: Recorder
    notes: list[str]

    def run(self) -> Iterator[float]:
        """Initialise, step to the stop time, terminate; raises `FmuError` or `SimulationError`."""
        s = self.settings
        self.events = EventHandler(self.instance, self.inputs, self.clocks, self.recorder)
        assert s.step_size is not None
        self.steps = Grid.of(s.start_time, s.step_size)
        self.rows = Grid.of(s.start_time, s.output_interval or s.step_size)
        self.stepper = Stepper(self.instance, self.notes)
        self.variable_step = self.instance.capabilities.can_handle_variable_step
        try:
            yield from self._steps()
        finally:
            self.stepper.close()
        with suppress(FmuError):  # what was computed is there
            self.instance.terminate()

    def _steps(self) -> Iterator[float]:
        s = self.settings
        time = s.start_time
        self.ended = self._initialise(time)
        self.recorder.record(time)
        yield time
        while not self.ended and time < s.stop_time:
            target = self._target(time)
            if target > s.stop_time:
                self._note_short(time, target)
                break
            time = self._step(time, target)
            yield time
        if self.ended:
            self.notes.append(f"the FMU asked to end the simulation at t = {time:.9g} s")

    def _initialise(self, time: float) -> bool:
        s = self.settings
        self.instance.enter_initialization_mode(time, s.stop_time, s.relative_tolerance)
        self.inputs.apply(self.instance, time)
        self.instance.exit_initialization_mode()
        return self.instance.event_mode and self.events.initial(time).terminate

    def _target(self, time: float) -> float:
        """The next communication point."""
        target = self.steps.after(time)
        if self.variable_step:
            rows = target if self.rows == self.steps else self.rows.after(time)
            events = min(self.inputs.next_event(time), self.clocks.next(time))
            target = min(target, rows, events, self.settings.stop_time)
        elif is_close(target, self.settings.stop_time, float(self.steps.step)):
            target = self.settings.stop_time
        return target

    def _step(self, time: float, target: float) -> float:
        if not self.instance.event_mode:
            self.inputs.apply(self.instance, time)
        else:
            self.inputs.apply_continuous(self.instance, time, after=True)
        outcome, planned = self.stepper.advance(time, target)
        if outcome.discarded:
            return self._discarded(time, outcome)
        divided, target = planned < target, planned
        early = outcome.time < target and not is_close(outcome.time, target, target - time)
        reached = outcome.time if early else target
        if early and not self.instance.early_return:
            raise FmuError(
                f"component {self.instance.name}: the step from t = {time:.9g} s to {target:.9g} s "
                f"ended at {outcome.time:.9g} s, though no early return was allowed"
            )
        event = self.instance.event_mode and self._event_at(time, reached, outcome)
        jump = self.inputs.next_event(time) == reached
        wanted = not divided and self._wanted(reached)
        if event or early or jump or outcome.terminate or wanted:
            self.recorder.record(reached)
        self.ended = outcome.terminate
        if event and not self.ended:
            self.ended = self.events.handle(reached).terminate
            self.recorder.record(reached)
        return reached

    def _event_at(self, time: float, reached: float, outcome: StepOutcome) -> bool:
        """Whether the FMU or the user wants an event at the end of the step."""
        theirs = self.inputs.next_event(time) <= reached or self.clocks.next(time) <= reached
        return outcome.event_needed or theirs or self.inputs.jumped(reached)

    def _wanted(self, time: float) -> bool:
        at_end = is_close(time, self.settings.stop_time, float(self.steps.step))
        return at_end or self.rows.holds(time) or self.settings.output_interval is None

    def _discarded(self, time: float, outcome: StepOutcome) -> float:
        if outcome.terminate:
            if outcome.time > time:
                self.recorder.record(outcome.time)
            self.ended = True
            return outcome.time
        raise SimulationError(
            f"component {self.instance.name}: the step at t = {time:.9g} s was discarded "
            f"(computed up to {outcome.time:.9g} s): {self.instance.log.reasons()}; "
            f"{self._way_out()}"
        )

    def _way_out(self) -> str:
        can = self.instance.capabilities
        if can.can_handle_variable_step and can.can_get_and_set_fmu_state:
            return f"so were {MOST_HALVINGS} smaller ones, each half as long as the one before"
        return "the FMU cannot go back, so try a smaller --step-size"

    def _note_short(self, time: float, target: float) -> None:
        self.notes.append(
            f"the run ends at t = {time:.9g} s: the FMU takes no steps but those of "
            f"{float(self.steps.step):g} s, and the next one would pass the stop time"
        )
