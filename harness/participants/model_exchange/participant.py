"""The participant that solves an FMU of model exchange: FMI 1, 2 and 3.

Python initialises, binds the functions of the FMU and explains faults; from one communication point
to the next everything is compiled (`kernels`). Inputs that have changed are given in event mode.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Iterator, Sequence

import numpy as np

from harness.compiler import operations as op
from harness.errors import EndRequestedError, FmuError, HarnessError, SimulationError
from harness.fmi.binding.continuous import ContinuousPart
from harness.fmi.binding.instance import FATAL, FmuInstance
from harness.fmi.binding.interface import MODEL_EXCHANGE
from harness.participants.fmu import FmuParticipant
from harness.participants.grid import Grid
from harness.participants.memory import Row
from harness.participants.model_exchange import context as x
from harness.participants.model_exchange.context import Context
from harness.participants.model_exchange.cvode import Cvode
from harness.participants.model_exchange.explicit import WORK_VECTORS
from harness.participants.model_exchange.kernels import entries
from harness.system.graph import Endpoint
from harness.system.policy import SOLVER_TOLERANCE

_METHODS = {"cvode": x.CVODE, "euler": x.EULER, "rk4": x.RK4, "dopri5": x.DOPRI5}
_MAX_STEP_SHARE = 50
_CALLS = {
    x.AT_SET_TIME: "SetTime", x.AT_SET_STATES: "SetContinuousStates",
    x.AT_GET_STATES: "GetContinuousStates", x.AT_DERIVATIVES: "Get(derivatives)",
    x.AT_INDICATORS: "GetEventIndicators", x.AT_NOMINALS: "GetNominalsOfContinuousStates",
    x.AT_COMPLETED: "CompletedIntegratorStep", x.AT_ENTER: "EnterEventMode",
    x.AT_UPDATE: "UpdateDiscreteStates", x.AT_LEAVE: "EnterContinuousTimeMode",
    x.AT_DIRECTIONAL: "GetDirectionalDerivative",
}  # fmt: skip
_NAMES = {
    1: {"UpdateDiscreteStates": "EventUpdate"}, 2: {"UpdateDiscreteStates": "NewDiscreteStates"},
    3: {},
}  # fmt: skip


class ModelExchange(FmuParticipant):
    """An FMU that is solved here; `part` its continuous part, `context` what compiled code knows
    of it."""

    kind = MODEL_EXCHANGE

    def instantiate(self) -> FmuInstance:
        """An instance whose solver is not yet there."""
        return self.made()

    def enter_initialization(self, start: float, stop: float | None) -> None:
        """As any FMU; the stop bounds the solver."""
        self._stop = math.inf if stop is None else stop
        self._largest = self.component.policy.largest_step
        self.context = Context()
        self.context.cells[x.INITIALISING] = 1
        self._advance, self._begin_write, self._settle = entries()
        self._solver: Cvode | None = None
        super().enter_initialization(start, stop)

    def leave_initialization(self, time: float) -> None:
        """Exit initialisation mode, handle the event at the start, set up the solver."""
        super().leave_initialization(time)
        self.part = ContinuousPart(self.instance)
        self._fill(time)
        settle = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64, ctypes.c_double)(
            self._settle.address
        )
        if self._iterate_first():
            self.check(settle(self.context.address, time))
        self.context.cells[x.INITIALISING] = 0
        self._solve_from(time)

    def _iterate_first(self) -> bool:
        """Whether the discrete states are to be iterated; FMI 1 has told already when it
        initialised."""
        if self.instance.prefix != "fmi":
            return True
        told = self.instance.update_discrete_states()
        if told.terminate:
            raise self._ended()
        at = told.next_event_time
        self.context.reals[x.EVENT_TIME] = math.inf if at is None else at
        return told.needs_update

    # the context

    def _fill(self, time: float) -> None:
        c, part, instance = self.context, self.part, self.instance
        d = self.description
        c.cells[x.HANDLE], c.cells[x.VERSION] = instance.handle or 0, d.fmi_major
        c.cells[x.NX], c.cells[x.NZ] = part.nx, part.nz
        modes = d.fmi_major > 1
        names = {
            x.SET_TIME: "SetTime",
            x.SET_STATES: "SetContinuousStates" if part.nx else "",
            x.GET_STATES: "GetContinuousStates" if part.nx else "",
            x.GET_DERIVATIVES: part.derivatives_name if part.nx else "",
            x.GET_INDICATORS: "GetEventIndicators" if part.nz else "",
            x.GET_NOMINALS: part.nominals_name if instance.offers(part.nominals_name) else "",
            x.COMPLETED: "CompletedIntegratorStep"
            if self.capabilities.needs_completed_integrator_step else "",
            x.ENTER_EVENTS: "EnterEventMode" if modes else "",
            x.UPDATE: _NAMES[d.fmi_major].get("UpdateDiscreteStates", "UpdateDiscreteStates"),
            x.LEAVE_EVENTS: "EnterContinuousTimeMode" if modes else "",
        }  # fmt: skip
        for place, name in names.items():
            c.cells[place] = instance.address(name) if name else 0
        n, nz = max(1, part.nx), max(1, part.nz)
        for place in (x.DX, x.DX_BEFORE):
            c.array(place, np.zeros(n))
        c.array(x.Z, np.zeros(nz))
        self._domains = c.array(x.DOMAINS, np.zeros(nz, dtype=np.int64))
        for place, size in ((x.INFO, 16), (x.TIME_OUT, 1), (x.REACHED, 1), (x.STOP_ASKED, 1)):
            c.array(place, np.zeros(size, dtype=np.int64))
        if self.around.reached is not None:
            c.cells[x.REACHED] = self.around.reached.ctypes.data
        if self.around.stop_asked is not None:
            c.cells[x.STOP_ASKED] = self.around.stop_asked.ctypes.data
        for place in (x.EVENT_TIME, x.HOOK_TIME, x.KINK_TIME):
            c.reals[place] = math.inf
        c.reals[x.TIME], c.reals[x.SEGMENT], c.reals[x.LAST_EVENT] = time, time, math.nan
        c.reals[x.RELATIVE] = self.tolerance or SOLVER_TOLERANCE
        c.reals[x.STOP_TIME] = self._stop
        c.cells[x.IN_EVENT] = int(modes)

    def _solve_from(self, time: float) -> None:
        """The states as they are now, and a solver that begins with them."""
        c, part = self.context, self.part
        policy, n = self.component.policy, max(1, part.nx)
        states = part.states() if part.nx else np.zeros(1)
        relative = float(c.reals[x.RELATIVE])
        absolute = relative * part.nominals() if part.nx else np.ones(1)
        if part.nz:
            self._domains[:] = part.indicators() > 0.0
        method = c.cells[x.METHOD] = _METHODS[policy.solver]
        step = self.component.step_ns / self.around.ticks_per_second
        length = self._stop - time
        share = length / _MAX_STEP_SHARE if math.isfinite(length) else step
        c.reals[x.LARGEST] = self._largest or (share if method == x.CVODE else math.inf)
        if method == x.CVODE:
            self._solver = Cvode(c, time, states, absolute, self._jacobian())
            return
        c.array(x.X, states)
        c.array(x.X_AT, np.zeros(n))
        c.array(x.ABSOLUTE, absolute)
        c.array(x.WORK, np.zeros(n * WORK_VECTORS))
        c.reals[x.STEP_SIZE] = min(self._largest or step, step)
        first, size, whole = Grid.of(time, self._largest or step).parts
        c.cells[x.GRID_FIRST], c.cells[x.GRID_STEP], c.cells[x.GRID_WHOLE] = first, size, whole

    def _jacobian(self) -> bool:
        """Whether the FMU gives its Jacobian; the references of states and derivatives go into
        the context."""
        d, c = self.description, self.context
        name = "GetDirectionalDerivative"
        pairs = [(d.variable(state), d.variable(rate)) for state, rate in d.states]
        if not (
            self.capabilities.provides_directional_derivatives and self.instance.offers(name)
            and len(pairs) == self.part.nx > 0 and not any(v.shape for p in pairs for v in p)
        ):  # fmt: skip
            return False
        for place, which in ((x.STATE_REFERENCES, 0), (x.RATE_REFERENCES, 1)):
            c.array(place, np.array([p[which].value_reference for p in pairs], dtype=np.uint32))
        c.array(x.SEED, np.ones(1))
        c.cells[x.DIRECTIONAL] = self.instance.address(name)
        return True

    # rows

    def write(self, inputs: Sequence[str]) -> Iterator[Row]:
        """Set inputs in event mode, where they have changed."""
        rows = list(super().write(inputs))
        ends = [Endpoint(self.name, n) for name in inputs for n in self.description.whole(name)]
        slots = [self.memory.address(self.memory.slot(end, "present")) for end in ends]
        last = np.full(len(slots), -1, dtype=np.int64)
        places = np.array(slots, dtype=np.int64)
        self.memory.held(last)
        writing = np.array(
            [self.context.address, len(slots), self.memory.held(places), last.ctypes.data, 0],
            dtype=np.int64,
        )
        place = self.memory.held(writing)
        yield [op.CALL_2, self._begin_write.address, place, 0]
        yield [op.SKIP, place + 32, len(rows)]
        yield from rows

    def step(self, ticks: int, final: bool) -> Iterator[Row]:
        """Solve to the next communication point."""
        yield [op.STEP_CALL, self._advance.address, self.context.address, ticks]

    def close(self) -> None:
        """Give the solver back, too."""
        if self._solver is not None:
            self._solver.close()
        super().close()

    # what a step came to

    def advance(self, start: float, target: float) -> None:
        """The same step outside the loop; raises `HarnessError`."""
        function = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64, ctypes.c_double, ctypes.c_double)(
            self._advance.address
        )
        self.check(function(self.context.address, start, target))

    def check(self, status: int) -> None:
        """Raise what a status of the kernels means."""
        if status != 0:
            fault = self.explained(status)
            raise fault

    def explained(self, status: int) -> BaseException:
        """The fault behind a status of the kernels."""
        found = super().explained(status)
        if found is not None:
            return found
        if status == op.ASKED + op.TERMINATED:
            return self._ended()
        c = self.context
        what, code = int(c.cells[x.FAILED]), int(c.cells[x.STATUS])
        when = f"t = {float(c.reals[x.FAILED_AT]):.9g} s"
        if what in _CALLS:
            name = _CALLS[what]
            name = _NAMES[self.description.fmi_major].get(name, name)
            if code == FATAL:
                self.instance.mark_dead()
            try:
                self.instance.check(code, name, f" at {when}")
            except FmuError as fault:
                return fault
        return SimulationError(f"component {self.name}: {self._words(what, code, when)}")

    def _words(self, what: int, code: int, when: str) -> str:
        match what:
            case x.UNSETTLED:
                return f"the event at {when} does not settle in 1000 iterations of its states"
            case x.CHATTERING:
                return (
                    f"more than 1000 events at {when}, one after the other: the model chatters, "
                    "and time stands still"
                )
            case x.STOPPED:
                return f"stopped at {when}"
            case x.STALLED:
                return (
                    f"the explicit method needs steps too small for any clock at {when}; try "
                    'solver = "cvode", which is for stiff equations'
                )
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

    def _ended(self) -> HarnessError:
        return EndRequestedError(
            f"component {self.name}: the FMU asked for the end of the run: "
            f"{self.instance.log.reasons()}"
        )
