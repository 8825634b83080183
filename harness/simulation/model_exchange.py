"""Solving one FMU in model exchange with CVODE: FMI 1, 2 and 3.

The solver takes internal steps up to the next time event, input event, kink of an input, clock
tick or the stop time, and never looks beyond. After every accepted step the FMU is told of it
(completedIntegratorStep), unless it wants not to be. Rows between are read from the FMU at states
interpolated by the solver's own polynomial. State events are the roots of the event indicators. At
every event a row is recorded on both sides: its time repeats.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.errors import FmuError, HarnessError, SimulationError
from harness.fmi.binding.continuous import ContinuousPart
from harness.fmi.binding.instance import DISCARD, FmuInstance
from harness.participants.grid import Grid
from harness.simulation.clocks import Clocks
from harness.simulation.cvode import Cvode
from harness.simulation.events import EventHandler, EventOutcome
from harness.simulation.inputs import Inputs
from harness.simulation.outputs import Recorder
from harness.simulation.settings import SOLVER_TOLERANCE, Settings
from harness.simulation.solver import Euler, Solver

_MAX_STEP_SHARE = 50
_OK = (0, 1)


@dataclass
class ModelExchange:
    """One run; `run` yields the time (s) after initialisation and after each step of
    the solver."""

    instance: FmuInstance
    settings: Settings
    inputs: Inputs
    clocks: Clocks
    recorder: Recorder
    notes: list[str]

    def run(self) -> Iterator[float]:
        """Initialise, solve to the stop time, terminate; raises `FmuError` or `SimulationError`."""
        s = self.settings
        self.events = EventHandler(self.instance, self.inputs, self.clocks, self.recorder)
        assert s.output_interval is not None
        self.rows = Grid.of(s.start_time, s.output_interval)
        self.fault: HarnessError | None = None
        time = s.start_time
        outcome = self._initialise(time)
        self.part = ContinuousPart(self.instance)
        self.recorder.record(time)
        yield time
        if not outcome.terminate and s.stop_time > s.start_time:
            yield from self._solve(time, outcome)
        else:
            self.ended = outcome.terminate
        if self.ended:
            last = self.recorder.last
            self.notes.append(f"the FMU asked to end the simulation at t = {last:.9g} s")
        with suppress(FmuError):  # what was computed is there
            self.instance.terminate()

    def _initialise(self, time: float) -> EventOutcome:
        s = self.settings
        tolerance = s.relative_tolerance
        self.instance.enter_initialization_mode(time, s.stop_time, tolerance)
        self.inputs.apply(self.instance, time)
        self.instance.exit_initialization_mode()
        return self.events.initial(time)

    def _solve(self, time: float, outcome: EventOutcome) -> Iterator[float]:
        self.segment = time
        self.next_row = 1
        self.ended = False
        solver = self._solver(time)
        try:
            while time < self.settings.stop_time and not self.ended:
                stop, is_event = self._stop(time, outcome.next_time)
                reached, root = self._step(solver, time, stop)
                due = self._rows_between(solver, reached)
                self._move(reached, solver.x)
                step_event = self._completed()
                time = reached
                if self.ended:
                    self.recorder.record(time)
                elif root or step_event or (is_event and time >= stop) or self._jumped(due, time):
                    outcome = self._event(solver, time)
                elif due or time >= self.settings.stop_time:
                    self.recorder.record(time)
                yield time
        finally:
            solver.close()

    def _solver(self, time: float) -> Solver:
        s = self.settings
        x = self.part.states() if self.part.nx else np.zeros(1)
        common = (self._derivatives, self._indicators, self.part.nz, time, x)
        if s.solver == "euler":
            assert s.step_size is not None
            return Euler(*common, s.step_size)
        relative = s.relative_tolerance or SOLVER_TOLERANCE
        largest = s.step_size or (s.stop_time - s.start_time) / _MAX_STEP_SHARE
        return Cvode(*common, relative, self._absolute(relative), largest)

    def _absolute(self, relative: float) -> NDArray[np.float64]:
        return relative * self.part.nominals() if self.part.nx else np.ones(1)

    def _stop(self, time: float, time_event: float) -> tuple[float, bool]:
        """How far the solver may go, and whether an event waits there."""
        event = min(time_event, self.inputs.next_event(time), self.clocks.next(time))
        stop = min(event, self.inputs.next_kink(time), self.settings.stop_time)
        if self.inputs.has_held_functions:
            stop = min(stop, self.rows.at(self.next_row))
        if stop <= time:  # a time event that is due now
            stop = math.nextafter(time, math.inf)
        return stop, event <= stop

    def _step(self, solver: Solver, time: float, stop: float) -> tuple[float, bool]:
        if stop - time <= 8 * math.ulp(max(abs(time), abs(stop))):  # too close for any solver
            return stop, False
        try:
            reached, root = solver.step(stop)
        except SimulationError as caught:
            if self.fault is not None:
                raise self.fault from caught
            raise SimulationError(
                f"component {self.instance.name}: {caught} after t = {time:.9g} s"
            ) from caught
        close = abs(reached - stop) <= 8 * math.ulp(max(abs(stop), abs(reached)))
        return (stop if close else reached), root

    def _rows_between(self, solver: Solver, reached: float) -> bool:
        """Record the rows due before `reached`; whether one is due at that very time."""
        while (at := self.rows.at(self.next_row)) < reached:
            self._move(at, solver.at(at))
            self.recorder.record(at)
            self.next_row += 1
        if at > reached:
            return False
        self.next_row += 1
        return True

    def _move(self, time: float, x: NDArray[np.float64]) -> None:
        self.part.move(time, x)
        self.inputs.apply_continuous(self.instance, time, after=False)

    def _jumped(self, due: bool, time: float) -> bool:
        return due and self.inputs.has_held_functions and self.inputs.jumped(time)

    def _completed(self) -> bool:
        if not self.instance.capabilities.needs_completed_integrator_step:
            return False
        event, self.ended = self.instance.completed_integrator_step()
        return event

    def _event(self, solver: Solver, time: float) -> EventOutcome:
        self.recorder.record(time)
        outcome = self.events.handle(time)
        self.segment = time
        self.ended = outcome.terminate
        if not self.ended:
            self.inputs.apply_continuous(self.instance, time, after=True)
        self.recorder.record(time)
        if not self.ended:
            relative = self.settings.relative_tolerance or SOLVER_TOLERANCE
            absolute = self._absolute(relative) if outcome.nominals_changed else None
            solver.restart(time, self.part.states() if self.part.nx else np.zeros(1), absolute)
        return outcome

    # what the solver calls; no exception may leave

    def _evaluate(self, time: float, states: int, out: int, read: str) -> int:
        try:
            part = self.part
            for status, name in (
                (part.set_time(time), "SetTime"),
                (part.set_states(states), "SetContinuousStates"),
            ):
                if status not in _OK:
                    return self._refused(status, name, time)
            self.inputs.apply_continuous(self.instance, time, after=time <= self.segment)
            status = (
                part.get_derivatives(out) if read == "derivatives" else part.get_indicators(out)
            )
            return 0 if status in _OK else self._refused(status, f"Get({read})", time)
        except HarnessError as caught:
            self.fault = caught
            return -1

    def _refused(self, status: int, name: str, time: float) -> int:
        """Ask the solver for a smaller step after Discard, else end."""
        try:
            self.instance.check(status, name, f" at t = {time:.9g} s")
        except FmuError as caught:
            self.fault = caught
        return 1 if status == DISCARD else -1

    def _derivatives(self, time: float, states: int, out: int) -> int:
        if not self.part.nx:
            ctypes.c_double.from_address(out).value = 0.0  # of the state that stands for none
            return 0
        return self._evaluate(time, states, out, "derivatives")

    def _indicators(self, time: float, states: int, out: int) -> int:
        return self._evaluate(time, states, out, "indicators")
