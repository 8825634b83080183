"""A run from a system as data to recorded rows.

    open FMUs -> check -> lower -> plan -> instantiate -> initialise -> link -> loop -> terminate

The loop is called for some cycles at a time, so that progress can be shown, rows written out and
Ctrl-C heard. Whatever ends a run early is returned as the outcome's fault; the rows before it
have been handed to the recorder.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from harness.compiler import operations as op
from harness.compiler.operations import CYCLE, INSTANT, OPERATION, ROWS
from harness.errors import EndRequestedError, HarnessError
from harness.fmi.binding.logger import LogMessage
from harness.fmi.fmu import Fmu
from harness.instruments.source import named_seed
from harness.master import host as hosts
from harness.master.faults import explain
from harness.master.host import Host
from harness.master.opened import descriptions_of
from harness.master.plan.planner import Plan, make_plan
from harness.master.program.link import Program, link
from harness.master.program.loop import run_cycles
from harness.master.recorded import recorded_ports
from harness.participants.fmu import Around, FmuParticipant
from harness.participants.kinds import sampled
from harness.participants.participant import Participant
from harness.system.check import check
from harness.system.graph import Endpoint, System
from harness.system.lowering import DelayComponent, expand_arrays, lower

_FIRST_CHUNK = 64
_CHUNK_SECONDS = 0.05
_EVENT_ROWS = 4096  # room for rows at events in each chunk
_SKIPPED = 4096  # cycles whose samples are drawn at once when a run begins in the middle

Progress = Callable[[float], None]
"""Called with the share of the run that is done, 0 to 1."""


class Recorder(Protocol):
    """Receives rows as they come."""

    def add_texts(self, new: Sequence[str | bytes]) -> None:
        """Strings and binaries that rows may name from now on, by their number."""

    def append(self, times: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        """Times (s, shape (n,)) and rows (n, columns); both are only valid during the call."""


@dataclass(frozen=True)
class Outcome:
    """How a run ended: at `end_ns`, with `fault` where it did not reach its stop time; `notes` say
    what participants had to derive or leave out."""

    end_ns: int
    fault: HarnessError | None
    wall_seconds: float
    notes: tuple[str, ...] = ()


def plan_system(
    system: System, fmus: Mapping[str, Fmu], record: tuple[str | Endpoint, ...] = ("*",)
) -> Plan:
    """Check, lower and plan; `record` are patterns of the signals to record."""
    descriptions = descriptions_of(system, fmus)
    system = expand_arrays(system, descriptions)
    check(system, descriptions)
    recorded = recorded_ports(system, descriptions, record)
    return make_plan(lower(system, descriptions), descriptions, recorded)


def execute(
    plan: Plan,
    fmus: Mapping[str, Fmu],
    recorder: Recorder,
    *,
    progress: Progress | None = None,
    echo: Callable[[str, LogMessage], None] | None = None,
    logging: bool | None = None,
    host: Host | None = None,
) -> Outcome:
    """Run `plan`; faults of the run itself come back in the outcome, not as exceptions.

    FMUs are asked for `logging` where it is true, or None and there is an `echo`.
    """
    began = time.perf_counter()
    system = plan.lowered.system
    verbose = echo is not None if logging is None else logging
    host = host or hosts.usual()
    around = Around(verbose, echo, system.ticks_per_second, host.told)
    run = _Run(plan, fmus, recorder, host, around)
    fault: HarnessError | None = None
    with ExitStack() as stack:
        try:
            run.open(stack)
            run.initialise()
            fault = run.loop(progress)
        except HarnessError as caught:
            fault = caught
        if isinstance(fault, EndRequestedError) and system.single:
            fault = None
            run.notes.append(f"the FMU asked to end the simulation at t = {run.last:.9g} s")
        if fault is None or isinstance(fault, EndRequestedError):
            for participant in run.participants.values():
                participant.terminate()
    end = system.stop_ns if fault is None else run.reached
    notes = (*run.notes, *(note for p in run.participants.values() for note in p.notes))
    return Outcome(end, fault, time.perf_counter() - began, notes)


class _Run:
    """One run: its participants, its program, and where it has come to."""

    def __init__(
        self, plan: Plan, fmus: Mapping[str, Fmu], recorder: Recorder, host: Host, around: Around
    ) -> None:
        self.plan, self.fmus, self.recorder = plan, fmus, recorder
        self.host, self.around = host, around
        self.system = plan.lowered.system
        self.participants: dict[str, Participant] = {}
        self.program: Program | None = None
        self.notes: list[str] = []
        self.last = self.system.seconds(self.system.start_ns)

    @property
    def reached(self) -> int:
        """The instant of the loop (ticks)."""
        start = self.system.start_ns
        return start if self.program is None else int(self.program.clock[INSTANT])

    def open(self, stack: ExitStack) -> None:
        """Make the participants; each is closed with `stack`."""
        for c in self.plan.lowered.fmus:
            made = FmuParticipant.of(c, self.fmus[c.name], self.around)
            stack.callback(made.close)
            self.participants[c.name] = made
        for component in self.plan.lowered.sampled:
            self.participants[component.name] = sampled(component)

    def initialise(self) -> None:
        """Set what is there at the start, pass it on, and end initialisation."""
        system = self.system
        start, stop = system.seconds(system.start_ns), system.seconds(system.stop_ns)
        for participant in self.participants.values():
            participant.enter_initialization(start, stop)
        descriptions = descriptions_of(system, self.fmus)
        program = link(self.plan, self.participants, descriptions, self.host.clock)
        self.program = program
        self.host.linked(program)
        self.recorder.add_texts(program.memory.texts.entries)
        program.memory.texts.added = lambda text: self.recorder.add_texts([text])
        for signal in program.signals:
            first = signal.source.sampler(named_seed(system.seed, signal.name))
            value = first.sample(np.array([system.start_ns + signal.phase_ns], dtype=np.int64))
            program.v[program.memory.slot(Endpoint(signal.name, "value"))] = value[0]
        self.host.loop(True)
        outcome = _call(program, program.initial, _Samples(program), (0, 0, 1, 1))
        self.host.loop(False)
        if outcome != op.OK:
            raise explain(program, outcome)
        program.clock[:] = 0
        for delay in self.plan.lowered.sampled:
            if isinstance(delay, DelayComponent):
                held = program.v[program.memory.slot(Endpoint(delay.name, "in"))]
                program.states[delay.name][1:] = held
        for participant in self.participants.values():
            participant.leave_initialization(start)

    def _observe(self, name: str, time: float) -> None:
        """Record a row at an event of an FMU inside a step; there is room."""
        assert self.program is not None
        program, row = self.program, int(self.program.clock[ROWS])
        instant, slots = program.events[name]
        clock = np.zeros(op.CLOCK_SIZE, dtype=np.int64)
        times, rows = self._times[row : row + 1], self._rows[row : row + 1]
        span = (0, 0, 1, 1)
        outcome = _call(program, instant, _Samples(program), span, rows, times, clock, slots)
        if outcome != op.OK:
            program.clock[OPERATION] = clock[OPERATION]
            raise explain(program, outcome)
        times[0] = time
        program.clock[ROWS] = row + 1

    def loop(self, progress: Progress | None) -> HarnessError | None:
        """Run all cycles, chunk by chunk; what ended them early."""
        assert self.program is not None
        program, host = self.program, self.host
        cycle_ns, record_ns = program.plan.cycle_ns, self.system.record_ns
        n_cycles = (self.system.stop_ns - self.system.start_ns) // cycle_ns + 1
        rows_per_cycle = cycle_ns // record_ns
        samples = _Samples(program)
        self._spare = _EVENT_ROWS if program.events else 0
        most = max(host.chunk_rows(len(program.recorded)), rows_per_cycle)
        host.most_rows(most + self._spare, len(program.recorded))
        chunk = min(_FIRST_CHUNK, most // rows_per_cycle)
        cycle = host.begin(program)
        samples.skip(cycle)
        while cycle < n_cycles:
            chunk = min(chunk, n_cycles - cycle, host.cycles_until(cycle))
            samples.fill(cycle, chunk)
            began = time.perf_counter()
            outcome = self._chunk(samples, cycle + chunk, chunk * rows_per_cycle)
            if outcome != op.OK:
                return explain(program, outcome)
            cycle = int(program.clock[CYCLE])
            if progress is not None:
                progress(min(1.0, cycle / n_cycles))
            host.between(cycle)
            if time.perf_counter() - began < _CHUNK_SECONDS:
                chunk = max(1, min(2 * chunk, most // rows_per_cycle))
            else:
                chunk = max(1, chunk // 2)
        for _ in program.tail[:1]:
            program.clock[CYCLE] = 0
            outcome = self._chunk(samples, 1, len(program.tail), program.tail)
            if outcome != op.OK:
                return explain(program, outcome)
        return None

    def _chunk(
        self, samples: _Samples, until: int, n_rows: int, instants: NDArray[np.int64] | None = None
    ) -> int:
        """Run to cycle `until`, and hand over the rows."""
        assert self.program is not None
        program, outcome = self.program, op.FULL
        while outcome == op.FULL:
            outcome = self._part(
                samples, until, n_rows, program.instants if instants is None else instants
            )
        return outcome

    def _part(self, samples: _Samples, until: int, n_rows: int, instants: NDArray[np.int64]) -> int:
        """Until all is done or there is no room for more rows."""
        assert self.program is not None
        program, host, system = self.program, self.host, self.system
        program.clock[ROWS] = 0
        columns = len(program.recorded)
        self._times, self._rows = host.room(n_rows + self._spare, columns)
        for name in program.events:
            program.fmus[name].observe(partial(self._observe, name), len(self._times))
        span = (system.start_ns, system.stop_ns, program.plan.cycle_ns, until)
        host.loop(True)
        try:
            return _call(program, instants, samples, span, self._rows, self._times)
        finally:
            host.loop(False)
            done = program.clock[ROWS]
            if done:
                times, rows = self._times[:done], self._rows[:done]
                if program.events:
                    times, rows = in_time_order(times, rows)
                self.last = float(times[-1])
                self.recorder.append(times, rows)


class _Samples:
    """The prepared samples of all signals, refilled for each chunk of cycles."""

    def __init__(self, program: Program) -> None:
        system = program.plan.lowered.system
        self.start, self.stop = system.start_ns, system.stop_ns
        self.cycle_ns = program.plan.cycle_ns
        self.signals = program.signals
        self.samplers = [s.source.sampler(named_seed(system.seed, s.name)) for s in program.signals]
        self.cursors = np.zeros(max(1, len(self.signals)), dtype=np.int64)
        self.values = np.zeros(1)

    def skip(self, cycles: int) -> None:
        """Bring all samplers to where they are after that many cycles: what they give depends on
        how many instants came before, not on how those were cut into chunks."""
        for first in range(0, cycles, _SKIPPED):
            self.fill(first, min(_SKIPPED, cycles - first))

    def fill(self, first_cycle: int, n_cycles: int) -> None:
        """Prepare the samples of `n_cycles` cycles from `first_cycle` on."""
        parts = []
        position = 0
        for i, (signal, sampler) in enumerate(zip(self.signals, self.samplers, strict=True)):
            first = self.start + first_cycle * self.cycle_ns
            times = np.arange(
                first + signal.phase_ns, first + n_cycles * self.cycle_ns, signal.period_ns
            )
            parts.append(sampler.sample(times[times <= self.stop].astype(np.int64)))
            self.cursors[i] = position
            position += len(parts[-1])
        if parts:
            self.values = np.concatenate(parts)


def in_time_order(
    times: NDArray[np.float64], rows: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rows in the order of time: participants step one after the other, so events of one may come
    before those that another one has recorded already."""
    if (np.diff(times) >= 0.0).all():
        return times, rows
    order = np.argsort(times, kind="stable")
    return times[order], rows[order]


def _call(
    program: Program,
    instants: NDArray[np.int64],
    samples: _Samples,
    span: tuple[int, int, int, int],
    rows: NDArray[np.float64] | None = None,
    times: NDArray[np.float64] | None = None,
    clock: NDArray[np.int64] | None = None,
    recorded: NDArray[np.int64] | None = None,
) -> int:
    outcome: int = run_cycles(
        program.code,
        instants,
        np.array((*span, program.plan.lowered.system.ticks_per_second), dtype=np.int64),
        program.clock if clock is None else clock,
        program.v,
        program.copies,
        program.scales,
        samples.values,
        samples.cursors,
        program.memory.exchange,
        program.recorded if recorded is None else recorded,
        np.empty((0, len(program.recorded))) if rows is None else rows,
        np.empty(0) if times is None else times,
    )
    return outcome
