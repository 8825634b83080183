"""An instance under examination in motion, in co-simulation or in model exchange alike.

Both go from one communication point to the next with constant inputs. In model exchange CVODE
begins anew at each point, with all events handled on the way, so that a run can be left and taken
up anywhere and still gives the same bits. Co-simulation is done as the loop does it: without event
mode and early return. This module refuses to judge.
"""

from __future__ import annotations

import ctypes
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import FmuError, HarnessError, SimulationError
from harness.fmi.binding.continuous import ContinuousPart
from harness.fmi.binding.instance import CO_SIMULATION, DISCARD, FmuInstance
from harness.participants.clocks import Clocks
from harness.participants.grid import is_close
from harness.participants.settings import SOLVER_TOLERANCE
from harness.simulation.cvode import Cvode
from harness.simulation.events import EventHandler, EventOutcome
from harness.simulation.outputs import Recorder

if TYPE_CHECKING:
    from harness.inspection.subject import Subject

Array = NDArray[np.float64]
_OK = (0, 1)


class Motion(ABC):
    """One `instance` of a `subject`; `ended`: the FMU has asked to end the simulation."""

    def __init__(self, subject: Subject, instance: FmuInstance) -> None:
        self.subject, self.instance = subject, instance
        self.inputs = subject.new_inputs()
        self.ended = False

    def begin(self) -> None:
        """Initialise a fresh or reset instance, with the times and the tolerance of `simulate`."""
        settings = self.subject.settings
        self.ended = False
        self.inputs.forget()
        self.instance.enter_initialization_mode(
            settings.start_time, None, settings.relative_tolerance
        )
        self.instance.exit_initialization_mode()

    def advance(self, steps: int | None = None, first: float = 0, factor: float = 1.0) -> Array:
        """Move and step; rows of what is watched after each step, shape (steps, n), fewer where
        the FMU ends the simulation.

        `steps` is the whole examination where None. The run is at step number `first`, and takes
        steps of `factor` times the usual length.
        """
        wanted = self.subject.steps if steps is None else steps
        length = factor * self.subject.step
        rows: list[Array] = []
        while len(rows) < wanted and not self.ended:
            time, end = (self._time(first + factor * k) for k in (len(rows), len(rows) + 1))
            self.step(time, end, length)
            rows.append(self.watch())
        return np.array(rows).reshape(len(rows), len(self.subject.labels))

    def _time(self, number: float) -> float:
        return self.subject.start + number * self.subject.step

    def watch(self) -> Array:
        """The watched variables, arrays element by element."""
        get = self.instance.get
        values = [np.ravel(get(v.name)).astype(float) for v in self.subject.watched]
        return np.concatenate(values) if values else np.zeros(0)

    @abstractmethod
    def step(self, time: float, end: float, length: float) -> None:
        """Set the inputs as they are at `time` and go on to `end` (s)."""

    def memory(self) -> dict[str, Any]:
        """What the master must remember with a snapshot of the FMU, as plain values."""
        return {}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from where `memory` was taken; the FMU has returned there itself."""
        self.ended = False
        self.inputs.forget()


class Stepping(Motion):
    """Co-simulation."""

    def step(self, time: float, end: float, length: float) -> None:
        """One communication step; raises `FmuError`."""
        self.inputs.apply(self.instance, time)
        outcome = self.instance.advance(time, length)
        self.ended = outcome.terminate
        if outcome.discarded and not outcome.terminate:
            self.instance.check(DISCARD, "DoStep", f" at t = {time:.9g} s")
        if not self.ended and not is_close(outcome.time, end, length):
            raise FmuError(
                f"component {self.instance.name}: the step from t = {time:.9g} s to {end:.9g} s "
                f"ended at {outcome.time:.9g} s, though no early return was allowed"
            )


class Solving(Motion):
    """Model exchange."""

    def begin(self) -> None:
        """Initialise, and handle the first event."""
        super().begin()
        start = self.subject.start
        self.clocks = Clocks(self.instance, start, {}, [])
        self.events = EventHandler(
            self.instance, self.inputs, self.clocks, Recorder(self.instance, ())
        )
        self._settle(self.events.initial(start))
        self.part = ContinuousPart(self.instance)

    def _settle(self, outcome: EventOutcome) -> None:
        self.ended, self.next_event = outcome.terminate, outcome.next_time

    def memory(self) -> dict[str, Any]:
        """The next time event, and the ticks that were planned."""
        return {"next event": self.next_event, "ticks": self.clocks.memory()}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Plan the events anew."""
        super().recall(memory)
        self.next_event = memory["next event"]
        self.clocks.recall(memory["ticks"])

    def watch(self) -> Array:
        """The watched variables, the states and their derivatives."""
        return np.concatenate([super().watch(), self.part.states(), self.part.derivatives()])

    def step(self, time: float, end: float, length: float) -> None:
        """An event that sets the inputs, then the solver; raises `HarnessError`."""
        if self.inputs.continuous or self.inputs.held:
            self._settle(self.events.handle(time))
        if not self.ended:
            solver = self._solver(time, length)
            try:
                self._solve(solver, time, end)
            finally:
                solver.close()

    def _solve(self, solver: Cvode, time: float, end: float) -> None:
        while time < end and not self.ended:
            event = min(self.next_event, self.clocks.next(time))
            stop = max(min(event, end), math.nextafter(time, math.inf))
            root = False
            if stop - time > 8 * math.ulp(max(abs(time), abs(stop))):
                time, root = self._reach(solver, stop)
            else:  # too close for any solver
                time = stop
            self.part.move(time, solver.x[: self.part.nx])
            asked = False
            if self.instance.capabilities.needs_completed_integrator_step:
                asked, self.ended = self.instance.completed_integrator_step()
            if not self.ended and (root or asked or time >= event):
                self._settle(self.events.handle(time))
                if not self.ended:
                    solver.restart(time, self._states())

    def _reach(self, solver: Cvode, stop: float) -> tuple[float, bool]:
        self._fault: HarnessError | None = None
        try:
            reached, root = solver.step(stop)
        except SimulationError as caught:
            raise self._fault or caught from caught
        near = abs(reached - stop) <= 8 * math.ulp(max(abs(stop), abs(reached)))
        return (stop if near else reached), root

    def _solver(self, time: float, length: float) -> Cvode:
        relative = self.subject.settings.relative_tolerance or SOLVER_TOLERANCE
        absolute = relative * self.part.nominals() if self.part.nx else np.ones(1)
        return Cvode(
            self._derivatives, self._indicators, self.part.nz, time, self._states(), relative,
            absolute, length,
        )  # fmt: skip

    def _states(self) -> Array:
        """The states; one that never moves where there are none, since CVODE wants one."""
        return self.part.states() if self.part.nx else np.zeros(1)

    def _derivatives(self, time: float, states: int, out: int) -> int:
        if not self.part.nx:
            ctypes.c_double.from_address(out).value = 0.0
            return 0
        return self._evaluate(time, states, out, "derivatives")

    def _indicators(self, time: float, states: int, out: int) -> int:
        return self._evaluate(time, states, out, "indicators")

    def _evaluate(self, time: float, states: int, out: int, what: str) -> int:
        """What the solver calls; no exception may leave."""
        part = self.part
        read = part.get_derivatives if what == "derivatives" else part.get_indicators
        for status in (part.set_time(time), part.set_states(states), read(out)):
            if status not in _OK:
                try:
                    self.instance.check(status, f"Get({what})", f" at t = {time:.9g} s")
                except FmuError as caught:
                    self._fault = caught
                return 1 if status == DISCARD else -1
        return 0


def motion_of(subject: Subject, instance: FmuInstance) -> Motion:
    """The motion of an instance, by its kind of interface."""
    stepping = instance.interface_type == CO_SIMULATION
    return Stepping(subject, instance) if stepping else Solving(subject, instance)
