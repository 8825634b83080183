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
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from harness.compiler import operations as op
from harness.compiler.operations import CYCLE, INSTANT, OPERATION, ROWS
from harness.errors import EndRequestedError, HarnessError
from harness.fmi.binding.logger import LogMessage, left_out
from harness.fmi.fmu import Fmu
from harness.instruments.source import named_seed
from harness.master import host as hosts
from harness.master.faults import explain
from harness.master.growth import CouplingGrowth
from harness.master.host import Host
from harness.master.items import UnknownItems
from harness.master.opened import descriptions_of
from harness.master.plan.planner import Plan, Planner
from harness.master.program.frame import Frame
from harness.master.program.link import Linker, Program
from harness.master.program.straight import lay_out
from harness.master.recorded import recorded_ports
from harness.participants.fmu import Around, FmuParticipant
from harness.participants.fresh import fresh
from harness.participants.kinds import sampled
from harness.participants.participant import Participant
from harness.system.check import check
from harness.system.enumerations import match_items
from harness.system.graph import Endpoint, System
from harness.system.lowering import DelayComponent, expand_arrays, lower

_FIRST_CHUNK = 64
_CHUNK_SECONDS = 0.05  # of the loop; what the recorder takes is less for longer chunks
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
    system, notes = match_items(system, descriptions)
    recorded = recorded_ports(system, descriptions, record)
    plan = Planner(lower(system, descriptions), descriptions, recorded).plan()
    return replace(plan, notes=(*notes, *plan.notes))


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
            run.loop(progress)
        except HarnessError as caught:
            fault = caught
        if isinstance(fault, EndRequestedError) and system.single:
            fault = None
            run.notes.append(f"the FMU asked to end the simulation at t = {run.last:.9g} s")
        if fault is None or isinstance(fault, EndRequestedError):
            for participant in run.participants.values():
                participant.terminate()
    if verbose and plan.lowered.fmus and (unseen := left_out()):
        run.notes.append(unseen)
    run.notes += filter(None, [run.growth.note(), *run.items.notes])
    end = system.stop_ns if fault is None else int(host.clock[INSTANT])
    notes = (*run.notes, *(note for p in run.participants.values() for note in p.notes))
    return Outcome(end, fault, time.perf_counter() - began, notes)


class _Run:
    """One run: its participants, its program, and where it has come to."""

    program: Program

    def __init__(
        self, plan: Plan, fmus: Mapping[str, Fmu], recorder: Recorder, host: Host, around: Around
    ) -> None:
        self.plan, self.fmus, self.recorder = plan, fmus, recorder
        self.host, self.around = host, around
        self.system = plan.lowered.system
        self.participants: dict[str, Participant] = {}
        self.notes: list[str] = []
        descriptions = descriptions_of(self.system, fmus)
        self.growth = CouplingGrowth(plan, descriptions)
        self.items = UnknownItems(plan, descriptions)
        self.last = self.system.seconds(self.system.start_ns)
        host.clock[INSTANT] = self.system.start_ns

    def open(self, stack: ExitStack) -> None:
        """Make the participants; each is closed with `stack`."""
        for c in self.plan.lowered.fmus:
            made = FmuParticipant.of(c, self.fmus[c.name], self.around)
            stack.callback(made.close)
            self.participants[c.name] = made
        for component in fresh(self.plan.lowered.sampled):
            self.participants[component.name] = sampled(component)

    def initialise(self) -> None:
        """Set what is there at the start, pass it on, and end initialisation."""
        system, clock = self.system, self.host.clock
        start, stop = system.seconds(system.start_ns), system.seconds(system.stop_ns)
        for participant in self.participants.values():
            participant.enter_initialization(start, stop)
        descriptions = descriptions_of(system, self.fmus)
        self.program = program = Linker(self.plan, self.participants, descriptions, clock).link()
        self.samples = _Samples(program)
        self.host.linked(program)
        self.recorder.add_texts(program.memory.texts.entries)
        program.memory.texts.added = lambda text: self.recorder.add_texts([text])
        for signal in program.signals:
            first = signal.source.sampler(named_seed(system.seed, signal.name))
            value = first.sample(np.array([system.start_ns + signal.phase_ns], dtype=np.int64))
            program.v[program.memory.slot(Endpoint(signal.name, "value"))] = value[0]
        self.host.loop(True)
        outcome = self._cycles(1, program.initial, np.empty(0), self._no_rows, clock)
        self.host.loop(False)
        self._check(outcome)
        clock[:] = 0
        clock[INSTANT] = system.start_ns
        for delay in self.plan.lowered.sampled:
            if isinstance(delay, DelayComponent):
                held = program.v[program.memory.slot(Endpoint(delay.name, "in"))]
                program.states[delay.name][1:] = held
        for participant in self.participants.values():
            participant.leave_initialization(start)

    @property
    def _no_rows(self) -> NDArray[np.float64]:
        return np.empty((0, len(self.program.recorded)))

    def loop(self, progress: Progress | None) -> None:
        """Run all cycles, chunk by chunk; raises what ended them early."""
        program, host = self.program, self.host
        cycle_ns = program.plan.cycle_ns
        n_cycles = (self.system.stop_ns - self.system.start_ns) // cycle_ns + 1
        rows_per_cycle = cycle_ns // self.system.record_ns
        self._spare = _EVENT_ROWS if program.events else 0
        most = max(host.chunk_rows(len(program.recorded)), rows_per_cycle)
        host.most_rows(most + self._spare, len(program.recorded))
        chunk = min(_FIRST_CHUNK, most // rows_per_cycle)
        cycle = host.begin(program)
        lay_out(program.code, program.instants, n_cycles - cycle)
        self.samples.skip(cycle)
        while cycle < n_cycles:
            chunk = min(chunk, n_cycles - cycle, host.cycles_until(cycle))
            self.samples.fill(cycle, chunk)
            self._spent = 0.0
            self._chunk(cycle + chunk, chunk * rows_per_cycle, program.instants)
            cycle = int(host.clock[CYCLE])
            if progress is not None:
                progress(min(1.0, cycle / n_cycles))
            host.between(cycle)
            if self._spent < _CHUNK_SECONDS:
                chunk = max(1, min(2 * chunk, most // rows_per_cycle))
            else:
                chunk = max(1, chunk // 2)
        if len(program.tail):
            host.clock[CYCLE] = 0
            self._chunk(1, len(program.tail), program.tail)

    def _chunk(self, until: int, n_rows: int, instants: NDArray[np.int64]) -> None:
        """Run to cycle `until`, and hand over the rows, also where there is no room for more."""
        program, clock, outcome = self.program, self.host.clock, op.FULL
        while outcome == op.FULL:
            clock[ROWS] = 0
            self._times, self._rows = self.host.room(n_rows + self._spare, len(program.recorded))
            for name in program.events:
                program.fmus[name].observe(partial(self._observe, name), len(self._times))
            self.host.loop(True)
            began = time.perf_counter()
            try:
                outcome = self._cycles(until, instants, self._times, self._rows, clock)
            finally:
                self.host.loop(False)
                self._spent += time.perf_counter() - began
                self._hand_over(int(clock[ROWS]))
        self._check(outcome)

    def _hand_over(self, done: int) -> None:
        """Give the rows that are done to the recorder."""
        if done:
            times, rows = self._times[:done], self._rows[:done]
            if self.program.events:
                times, rows = in_time_order(times, rows)
            self.last = float(times[-1])
            self.growth.see(times, rows)
            self.items.see(times, rows)
            self.recorder.append(times, rows)

    def _observe(self, name: str, time: float) -> None:
        """Record a row at an event of an FMU inside a step; there is room."""
        program, row = self.program, int(self.host.clock[ROWS])
        instant, slots = program.events[name]
        clock = np.zeros(op.CLOCK_SIZE, dtype=np.int64)
        times, rows = self._times[row : row + 1], self._rows[row : row + 1]
        outcome = self._cycles(1, instant, times, rows, clock, slots)
        if outcome != op.OK:
            self.host.clock[OPERATION] = clock[OPERATION]
        self._check(outcome)
        times[0] = time
        self.host.clock[ROWS] = row + 1

    def _cycles(
        self, until: int, instants: NDArray[np.int64], times: NDArray[np.float64],
        rows: NDArray[np.float64], clock: NDArray[np.int64],
        recorded: NDArray[np.int64] | None = None,
    ) -> int:  # fmt: skip
        """Run `instants` to cycle `until`; the outcome."""
        p, system, samples = self.program, self.system, self.samples
        return Frame(
            p.code, instants, clock, p.v, p.copies, p.scales, samples.values, samples.cursors,
            p.memory.exchange, p.recorded if recorded is None else recorded, rows, times,
            system.start_ns, system.stop_ns, p.plan.cycle_ns, system.ticks_per_second, until,
        ).run()  # fmt: skip

    def _check(self, outcome: int) -> None:
        """Raise what an outcome other than OK means."""
        if outcome != op.OK:
            raise explain(self.program, outcome)


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
