"""Runs one FMU by `plain_fmu`, scipy and nothing of the harness: the oracle of these tests.

Rows are taken at 0, step, 2 step, …, after what happens at that time and before inputs change.
Inputs are staircases that change at these times. Times are whole nanoseconds; those of the events
of a solver or of an early return are what they are.
"""

import ctypes as c
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from tests.every_way.plain_fmu import EventInfo1, EventInfo2, PlainFmu

SECOND = 1_000_000_000
Steps = tuple[tuple[int, Any], ...]
"""Pairs of a time (ns) and the value from then on, the first one at 0."""


@dataclass(frozen=True)
class Job:
    """What is to be run; `watched` are names of variables, `triggers` times (ns) of clocks."""

    path: Path
    kind: str
    step_ns: int
    steps: int
    watched: tuple[str, ...]
    inputs: dict[str, Steps] = field(default_factory=dict)
    start_values: dict[str, Any] = field(default_factory=dict)
    event_mode: bool = False
    triggers: dict[str, tuple[int, ...]] = field(default_factory=dict)


class Run:
    """One run; `rows[name]` are the values of a watched variable."""

    def __init__(self, job: Job, fmu: PlainFmu) -> None:
        self.job, self.fmu = job, fmu
        self.rows: dict[str, list[Any]] = {name: [] for name in job.watched}
        self.pending: dict[str, int] = {}
        self.ticked: dict[str, int] = {}
        self.next_event = math.inf
        self.clocks = {n: v for n, v in fmu.variables.items()
                       if v.type == "Clock" and v.causality == "input"}  # fmt: skip

    def row(self) -> None:
        for name, values in self.rows.items():
            values.append(self.fmu.get(name))

    def set_inputs(self, ns: int) -> bool:
        """Set what changes at `ns`; whether something does."""
        changed = False
        for name, steps in self.job.inputs.items():
            for time, value in steps:
                if time == ns:
                    self.fmu.set(name, value)
                    changed = True
        return changed

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
                ticks = ns in self.job.triggers.get(name, ()) or self.pending.get(name) == ns
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

    # the kinds

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
            if k and not self.job.event_mode:
                self.set_inputs(ns)
            if (
                k
                and self.job.event_mode
                and any(t == ns for s in self.job.inputs.values() for t, _ in s)
            ):
                self.handle(ns / SECOND)
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
            for name in self.due(ns):
                self.tick([name], ns)
                reference = c.c_uint32(self.clocks[name].reference)
                before = self.fmu.updates
                self.fmu.call("ActivateModelPartition", reference, c.c_double(ns / SECOND))
                if self.fmu.updates > before:
                    self.count_down(ns)
            self.row()

    def model_exchange(self) -> None:
        self.initialise()
        self.nx, self.nz = self._counts()
        self.row()
        for k in range(self.job.steps):
            ns = k * self.job.step_ns
            if k and any(t == ns for s in self.job.inputs.values() for t, _ in s):
                self.handle(ns / SECOND)
            time, target = ns / SECOND, (k + 1) * self.job.step_ns / SECOND
            while time < target:
                time = self._reach(time, min(target, self.next_event))
            self.row()

    def _counts(self) -> tuple[int, int]:
        root = self.fmu.root
        if self.fmu.version == "3":
            found = [len(root.findall(f"ModelStructure/{tag}"))
                     for tag in ("ContinuousStateDerivative", "EventIndicator")]  # fmt: skip
            return found[0], found[1]
        states = len(root.findall("ModelStructure/Derivatives/Unknown"))
        states = int(root.get("numberOfContinuousStates", states))
        return states, int(root.get("numberOfEventIndicators", 0))

    def _reach(self, time: float, stop: float) -> float:
        """Integrate to `stop` or to the first event, and handle what happens there."""
        x = self._vector("GetContinuousStates", self.nx)
        state_event = False
        if self.nx:
            functions = [self._indicator(i, time, x) for i in range(self.nz)]
            found = solve_ivp(self._rates, (time, stop), x, "DOP853", events=functions or None,
                              rtol=1e-12, atol=1e-13)  # fmt: skip
            assert found.success, found.message
            time, x = found.t[-1], found.y[:, -1]
            state_event = found.status == 1
        time = stop if not state_event else time
        self._move(time, x)
        wanted, terminate = (c.c_char(), c.c_char()) if self.fmu.version == "1" else (
            (c.c_int(), c.c_int()) if self.fmu.version == "2" else (c.c_bool(), c.c_bool())
        )  # fmt: skip
        more = {"1": (), "2": (1, c.byref(wanted), c.byref(terminate)),
                "3": (c.c_bool(True), c.byref(wanted), c.byref(terminate))}  # fmt: skip
        self.fmu.call("CompletedIntegratorStep", *(more[self.fmu.version] or (c.byref(wanted),)))
        asked = wanted.value not in (0, b"\0", False)
        ns = round(time * SECOND)
        if state_event or asked or time >= self.next_event or self.due(ns):
            self.handle(time)
        return time

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
