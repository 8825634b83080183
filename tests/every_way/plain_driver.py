"""Runs one FMU by `plain_fmu`, scipy and nothing of the harness: the oracle of these tests.

Rows are taken at 0, step, 2 step, …, after what happens at that time and before inputs change.
"""

import ctypes as c
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from tests.every_way.plain_events import SECOND, Events, Job
from tests.every_way.plain_fmu import EventInfo1, PlainFmu


class Run(Events):
    """One run of any kind."""

    def initialise(self) -> None:
        fmu = self.fmu
        for name, value in self.job.start_values.items():
            fmu.set(name, value)
        stop = self.job.steps * self.job.step_ns / SECOND
        experiment = fmu.root.find("DefaultExperiment")
        tolerance = None if experiment is None else experiment.get("tolerance")
        given, relative = tolerance is not None, c.c_double(float(tolerance or 0.0))
        if fmu.version == "1" and self.job.kind == "model-exchange":
            fmu.call("SetTime", c.c_double(0.0))
        if fmu.version == "2":
            fmu.call("SetupExperiment", int(given), relative, c.c_double(0.0), 1, c.c_double(stop))
        if fmu.version == "2":
            fmu.call("EnterInitializationMode")
        if fmu.version == "3":
            fmu.call("EnterInitializationMode", c.c_bool(given), relative, c.c_double(0.0),
                     c.c_bool(True), c.c_double(stop))  # fmt: skip
        self.set_inputs(0)
        if fmu.version != "1":
            fmu.call("ExitInitializationMode")
        elif self.job.kind == "co-simulation":
            fmu.call("InitializeSlave", c.c_double(0.0), c.c_char(1), c.c_double(stop))
        else:
            info = EventInfo1()
            fmu.call("Initialize", c.c_char(given), relative, c.byref(info))
            self._told(False, bool(ord(info.upcoming)), info.next)
        if self.job.event_mode or (self.job.kind == "model-exchange" and fmu.version != "1"):
            self.handle(0.0, enter=False)

    def co_simulation(self) -> None:
        self.initialise()
        self.row()
        for k in range(self.job.steps):
            ns, after = k * self.job.step_ns, (k + 1) * self.job.step_ns
            if k and self.begins(ns) and self.job.event_mode:
                self.handle(ns / SECOND)
            elif k:
                self.set_inputs(ns)
            time, target = ns / SECOND, after / SECOND
            while time < target:
                time = self._step(time, target)
            self.row()

    def _step(self, time: float, target: float) -> float:
        head = (c.c_double(time), c.c_double(target - time))
        if self.fmu.version != "3":
            self.fmu.call("DoStep", *head, c.c_char(1) if self.fmu.version == "1" else 1)
            return target
        event, terminate, early, last = c.c_bool(), c.c_bool(), c.c_bool(), c.c_double()
        self.fmu.call("DoStep", *head, c.c_bool(True), c.byref(event), c.byref(terminate),
                      c.byref(early), c.byref(last))  # fmt: skip
        time = last.value if early else target
        if self.job.event_mode and (event or self.due(round(time * SECOND))):
            self.handle(time)
        return time

    def scheduled_execution(self) -> None:
        self.initialise()
        for ns in range(0, self.job.steps * self.job.step_ns + 1, self.job.step_ns):
            if ns:
                self.set_inputs(ns)
            self._activate(ns)
            self.row()
            if self.begins(ns):
                self._activate(ns)

    def _activate(self, ns: int) -> None:
        """What ticks, one after the other: the activation of one may start another."""
        while ticking := self.due(ns):
            name = ticking[0]
            self.tick([name], ns)
            reference = c.c_uint32(self.clocks[name].reference)
            before = self.fmu.updates
            self.fmu.call("ActivateModelPartition", reference, c.c_double(ns / SECOND))
            if self.fmu.updates > before:
                self.count_down(ns)

    def model_exchange(self) -> None:
        self.initialise()
        self.nx, self.nz = self._counts()
        self.row()
        for k in range(self.job.steps):
            ns = k * self.job.step_ns
            if k and self.begins(ns):
                self.handle(ns / SECOND)
            time, target = ns / SECOND, (k + 1) * self.job.step_ns / SECOND
            while time < target:
                time = self._reach(time, min(target, self.next_event))
            self.row()

    def _counts(self) -> tuple[int, int]:
        root = self.fmu.root
        if self.fmu.version == "3":

            def count(tag: str) -> int:
                references = {e.get("valueReference") for e in root.iter(tag)}
                return sum(self.fmu.size(v) for v in by_reference.values()
                           if str(v.reference) in references)  # fmt: skip

            by_reference = {v.reference: v for v in self.fmu.variables.values()}
            return count("ContinuousStateDerivative"), count("EventIndicator")
        states = len(root.findall("ModelStructure/Derivatives/Unknown"))
        states = int(root.get("numberOfContinuousStates", states))
        return states, int(root.get("numberOfEventIndicators", 0))

    def _reach(self, time: float, stop: float) -> float:
        """Go to `stop` or to the first event, and handle what happens there."""
        x, state_event = np.zeros(0), False
        if self.nx:
            time, x, state_event = self._integrate(time, stop)
        time = time if state_event else stop
        self._move(time, x)
        kind = {"1": c.c_bool, "2": c.c_int, "3": c.c_bool}[self.fmu.version]
        asked, terminate = kind(), kind()
        more = {"1": (), "2": (1,), "3": (c.c_bool(True),)}[self.fmu.version]
        last = (c.byref(terminate),) if more else ()
        self.fmu.call("CompletedIntegratorStep", *more, c.byref(asked), *last)
        if state_event or asked or time >= self.next_event or self.due(round(time * SECOND)):
            self.handle(time)
        return time

    def _integrate(self, time: float, stop: float) -> tuple[float, Any, bool]:
        """Time and states at `stop`, or just behind the first zero of an indicator (true)."""
        x = self._vector("GetContinuousStates", self.nx)
        zeros = [self._indicator(i, time, x) for i in range(self.nz)]
        found = solve_ivp(self._rates, (time, stop), x, "DOP853", dense_output=True,
                          events=zeros or None, rtol=1e-12, atol=1e-13)  # fmt: skip
        assert found.success, found.message
        if found.status != 1:
            return stop, found.y[:, -1], False
        zero = next(z for z, t in zip(zeros, found.t_events, strict=True) if len(t))
        behind = (found.t[-1] + 2.0**k * np.spacing(found.t[-1]) for k in range(30))
        time = next(
            t for t in (found.t[-1], *behind) if zero.direction * zero(t, found.sol(t)) >= 0
        )
        return time, found.sol(time), True

    def _move(self, time: float, x: Any) -> None:
        self.fmu.call("SetTime", c.c_double(time))
        if self.nx:
            self.fmu.call("SetContinuousStates", (c.c_double * self.nx)(*x), c.c_size_t(self.nx))

    def _vector(self, name: str, n: int) -> Any:
        room = (c.c_double * n)()
        if n:
            self.fmu.call(name, room, c.c_size_t(n))
        return np.array(room)

    def _rates(self, time: float, x: Any) -> Any:
        self._move(time, x)
        states = "ContinuousState" if self.fmu.version == "3" else ""
        return self._vector(f"Get{states}Derivatives", self.nx)

    def _indicator(self, i: int, time: float, x: Any) -> Any:
        """Indicator `i` as scipy wants it; one that begins at zero is on its positive side."""

        def function(t: float, y: Any) -> float:
            self._move(t, y)
            return float(self._vector("GetEventIndicators", self.nz)[i])

        function.terminal = True  # type: ignore[attr-defined]
        function.direction = -1.0 if function(time, x) > -1e-9 else 1.0  # type: ignore[attr-defined]
        return function


def drive(job: Job) -> dict[str, list[Any]]:
    """The rows of each watched variable."""
    with PlainFmu(job.path, job.kind, job.event_mode) as fmu:
        run = Run(job, fmu)
        kinds = {"co-simulation": run.co_simulation, "model-exchange": run.model_exchange,
                 "scheduled-execution": run.scheduled_execution}  # fmt: skip
        kinds[job.kind]()
        return run.rows
