"""The participant that solves an FMU of model exchange: FMI 1, 2 and 3.

Python initialises, binds the functions of the FMU and explains faults; from one communication point
to the next everything is compiled (`kernels`). Inputs that have changed are given in event mode.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compiler import operations as op
from harness.fmi.binding.continuous import ContinuousPart
from harness.fmi.binding.interface import MODEL_EXCHANGE
from harness.participants import context as x
from harness.participants.driven import DrivenParticipant
from harness.participants.grid import Grid
from harness.participants.memory import Row
from harness.participants.model_exchange.cvode import Cvode
from harness.participants.model_exchange.explicit import WORK_VECTORS
from harness.participants.model_exchange.kernels import entries
from harness.system.policy import SOLVER_TOLERANCE

_METHODS = {"cvode": x.CVODE, "euler": x.EULER, "rk4": x.RK4, "dopri5": x.DOPRI5}
_MAX_STEP_SHARE = 50
_DIRECTIONAL = "GetDirectionalDerivative"


class ModelExchange(DrivenParticipant):
    """An FMU that is solved here; `part` is its continuous part."""

    kind = MODEL_EXCHANGE
    _solver: Cvode | None = None

    def enter_initialization(self, start: float, stop: float | None) -> None:
        """As any FMU with events."""
        self._close_solver()
        super().enter_initialization(start, stop)
        self.context.cells[x.INITIALISING] = 1
        self._advance, self._begin_write = entries()
        self._last: list[NDArray[np.int64]] = []

    def leave_initialization(self, time: float) -> None:
        """Exit initialisation mode, handle the event at the start, set up the solver."""
        super().leave_initialization(time)
        self.context.cells[x.INITIALISING] = 0
        self._solve_from(time)

    def first_event(self) -> bool:
        """FMI 1 has told already when it initialised."""
        if self.instance.prefix != "fmi":
            return True
        told = self.instance.update_discrete_states()
        if told.terminate:
            raise self.ended()
        at = told.next_event_time
        self.context.reals[x.EVENT_TIME] = math.inf if at is None else at
        return told.needs_update

    def functions(self) -> dict[int, str]:
        """Those of the continuous part, too."""
        part, nominals = self.part, self.part.nominals_name
        completed = self.capabilities.needs_completed_integrator_step
        return super().functions() | {
            x.SET_TIME: "SetTime",
            x.SET_STATES: "SetContinuousStates" if part.nx else "",
            x.GET_STATES: "GetContinuousStates" if part.nx else "",
            x.GET_DERIVATIVES: part.derivatives_name if part.nx else "",
            x.GET_INDICATORS: "GetEventIndicators" if part.nz else "",
            x.GET_NOMINALS: nominals if part.nx and self.instance.offers(nominals) else "",
            x.COMPLETED: "CompletedIntegratorStep" if completed else "",
        }

    def fill_events(self) -> None:
        """The continuous part, too."""
        c = self.context
        self.part = part = ContinuousPart(self.instance)
        super().fill_events()
        c.cells[x.NX], c.cells[x.NZ] = part.nx, part.nz
        n, nz = max(1, part.nx), max(1, part.nz)
        for place, size in ((x.DX, n), (x.DX_BEFORE, n), (x.Z, nz), (x.TIME_OUT, 1)):
            c.array(place, np.zeros(size))
        self._domains = c.array(x.DOMAINS, np.zeros(nz, dtype=np.int64))
        c.reals[x.RELATIVE] = self.tolerance or SOLVER_TOLERANCE
        c.reals[x.STOP_TIME] = self._stop

    def _solve_from(self, time: float) -> None:
        """The states as they are now, and a solver that begins with them."""
        c, part, largest = self.context, self.part, self.component.policy.largest_step
        c.reals[x.TIME] = c.reals[x.SEGMENT] = c.reals[x.BEFORE_TIME] = time
        n, step = max(1, part.nx), self.seconds
        states = part.states() if part.nx else np.zeros(1)
        absolute = float(c.reals[x.RELATIVE]) * part.nominals() if part.nx else np.ones(1)
        if part.nz:
            self._domains[:] = part.indicators() > 0.0
        method = c.cells[x.METHOD] = _METHODS[self.component.policy.solver]
        alone = not self.driven_by_wires and not self.inputs.has_held_functions
        c.cells[x.FREE] = int(alone and method in (x.CVODE, x.EULER))
        length = self._stop - time
        share = length / _MAX_STEP_SHARE if math.isfinite(length) and length > 0.0 else step
        c.reals[x.LARGEST] = largest or (share if method == x.CVODE else math.inf)
        if method == x.CVODE:
            self._solver = Cvode(c, time, states, absolute, self._jacobian())
            return
        c.array(x.X, states)
        c.array(x.X_AT, np.zeros(n))
        c.array(x.ABSOLUTE, absolute)
        c.array(x.WORK, np.zeros(n * WORK_VECTORS))
        c.reals[x.STEP_SIZE] = min(largest or step, step)
        grid = Grid.of(time, largest or step).parts
        c.cells[x.GRID_FIRST], c.cells[x.GRID_STEP], c.cells[x.GRID_WHOLE] = grid

    def _jacobian(self) -> bool:
        """Whether the FMU gives its Jacobian; the references of states and derivatives go into
        the context."""
        d, c = self.description, self.context
        pairs = [(d.variable(state), d.variable(rate)) for state, rate in d.states]
        offered = self.capabilities.provides_directional_derivatives
        scalar = not any(v.shape for pair in pairs for v in pair)
        plain = len(pairs) == self.part.nx > 0 and scalar and not self.inputs.continuous
        if not (offered and plain and self.instance.offers(_DIRECTIONAL)):
            return False
        for place, which in ((x.STATE_REFERENCES, 0), (x.RATE_REFERENCES, 1)):
            c.array(place, np.array([p[which].value_reference for p in pairs], dtype=np.uint32))
        c.array(x.SEED, np.ones(1))
        c.cells[x.DIRECTIONAL] = self.instance.address(_DIRECTIONAL)
        return True

    # rows

    driven_by_wires = False
    """Whether inputs may change at every communication point."""

    def write(self, inputs: Sequence[str]) -> Iterator[Row]:
        """Set inputs in event mode, where they have changed; clocks tick where a wire says so."""
        self.driven_by_wires = True
        given, inputs = len(inputs), self.unclocked(inputs)
        if len(inputs) < given:
            yield self.calling(self._trigger)
        rows = list(super().write(inputs))
        ports = [port for name in inputs for port in self.description.scalars(name)]
        slots = [self.memory.address(self.slot(port)) for port in ports]
        places = self.memory.held(np.array(slots, dtype=np.int64))
        self._last.append(np.full(len(slots), -1, dtype=np.int64))
        last = self.memory.held(self._last[-1])
        writing = [self.context.address, len(slots), places, last, 0]
        place = self.memory.held(np.array(writing, dtype=np.int64))
        yield [op.CALL_2, self._begin_write.address, place, 0]
        yield [op.SKIP, place + 32, 1 + len(rows)]
        yield from rows

    def _trigger(self) -> None:
        """Enter event mode where a wire to a clock carries true."""
        cells = self.context.cells
        self.look_for_triggers()
        if self.hook.triggered and not (cells[x.INITIALISING] or cells[x.IN_EVENT]):
            self.instance.enter_event_mode()
            cells[x.IN_EVENT] = 1

    # snapshots

    @property
    def _stores(self) -> bool:
        return self.instance.capabilities.can_get_and_set_fmu_state

    def save(self) -> Iterator[Row]:
        """Get the FMU state; where there is none, states and time are all there is to remember."""
        if self._stores:
            yield from super().save()
            return
        self.notes.append(
            "the FMU cannot store its state, but declares nothing besides its continuous states: "
            "a step is repeated from these and the time"
        )
        yield self.calling(self._remember)

    def restore(self) -> Iterator[Row]:
        """Set the FMU state, or what there is in its place; inputs will be set anew."""
        if self._stores:
            yield from super().restore()
        else:
            yield self.calling(lambda: self.recall(self._snapshot))

    def remembered(self) -> dict[str, Any]:
        """What the importer must remember with a snapshot of the FMU, or in place of one."""
        found = super().remembered()
        if self._stores:
            return found
        time = float(self.context.reals[x.TIME])
        return found | {"time": time, "states": self.part.states().tolist()}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from where the FMU and `memory` come from: all inputs will be set anew."""
        if "states" in memory:
            self._return(memory)
        super().recall(memory)
        self.context.cells[x.UNFINISHED] = 0
        for last in self._last:
            last[:] = -1
        self.begin_anew()

    def _return(self, memory: Mapping[str, Any]) -> None:
        """Set time and states, which is allowed outside of event mode."""
        instance, modes = self.instance, self.instance.prefix != "fmi"
        if modes and self.context.cells[x.IN_EVENT]:
            self.check(self._settle(self.context.address, memory["time"]))
        instance.call("SetTime", ctypes.c_double(memory["time"]))
        self.part.set_states(np.array(memory["states"]))
        if modes and memory["in event mode"]:
            instance.enter_event_mode()

    def step(self, ticks: int, final: bool) -> Iterator[Row]:
        """Solve to the next communication point."""
        yield [op.STEP_CALL, self._advance.address, self.context.address, ticks]

    def close(self) -> None:
        """Give the solver back, too."""
        self._close_solver()
        super().close()

    def _close_solver(self) -> None:
        if self._solver is not None:
            self._solver.close()
        self._solver = None

    # outside of the loop

    def give(self, values: Mapping[str, Any]) -> None:
        """Set inputs in event mode, which the next step leaves."""
        if values and self.instance.prefix != "fmi" and not self.context.cells[x.IN_EVENT]:
            self.instance.enter_event_mode()
        if values:
            self.context.cells[x.IN_EVENT] = 1
        super().give(values)

    def begin_anew(self) -> None:
        """Let the next step begin with the states of the FMU, and no memory of earlier steps."""
        if self.context.cells[x.IN_EVENT] == 0:
            self.context.cells[x.INITIALISING] = 1
        if self.part.nx:
            states = self.part.states()
            ctypes.memmove(int(self.context.cells[x.X]), states.ctypes.data, states.nbytes)

    # what a step came to

    def advance(self, start: float, target: float) -> None:
        """The same step outside the loop; raises `HarnessError`."""
        self.check(self._advance.ctypes(self.context.address, start, target))

    def words(self, what: int, code: int, when: str) -> str:
        """What ended a step: the solver, or what any participant with events may meet."""
        if what == x.STALLED:
            return (
                f"the explicit method needs steps too small for any clock at {when}; try "
                'solver = "cvode", which is for stiff equations'
            )
        if what != x.AT_SOLVER:
            return super().words(what, code, when)
        message = "" if self._solver is None else self._solver.message
        return (
            f"the solver CVODE failed ({code}): {message} after {when}{self._worst()}; try a "
            "larger tolerance, a smaller largest_step, or look at the equations there"
        )

    def _worst(self) -> str:
        if self._solver is None or not self.part.nx:
            return ""
        i = self._solver.worst_state(self.part.nx)
        names = [state for state, _ in self.description.states]
        name = names[i] if len(names) == self.part.nx else f"number {i + 1}"
        return f", where the state {name} has the largest error"
