"""What happens in the worker of a run: open, plan, execute, and tell the supervisor.

It writes no file of its own but what FMUs are unpacked to, and decides nothing: rows, faults and
the state for checkpoints go to the supervisor.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from harness.compiler.operations import CYCLE, INSTANT
from harness.errors import ExperimentError, FmuError
from harness.fmi.binding.logger import LogMessage
from harness.fmi.fmu import Fmu
from harness.master.host import Rows, Times
from harness.master.plan.planner import Plan
from harness.master.prepared import PreparedSystem
from harness.master.program.link import Program
from harness.master.run import execute
from harness.process.checkpoint import Snapshot, differences, made_of, restore, take, why_not
from harness.process.limits import Limits
from harness.process.loops import VisibleHost
from harness.process.marker import RowMemory
from harness.process.recorder import RunRecorder
from harness.process.task import StopAskedError, Teller
from harness.system.graph import Endpoint, System

_LEAST_ROWS, _MOST_ROWS = 4096, 32768
_CHUNK_BYTES = 2**23  # memory fresh from the system is slow to touch, and here both sides do


@dataclass(frozen=True)
class Job:
    """What a worker has to run: `logging` asks FMUs to log, `limits` say when there are to be
    checkpoints, `resumed` what to begin with."""

    system: System
    record: tuple[str | Endpoint, ...] = ("*",)
    needed: tuple[str, ...] = ()
    logging: bool = False
    limits: Limits = field(default_factory=Limits)
    resumed: Snapshot | None = None


def run_job(job: Job, row_memory: int, teller: Teller) -> None:
    """Run `job` to its end; `row_memory` is the descriptor of the rows' memory."""
    host = _Host(job, row_memory, teller)
    with PreparedSystem(job.system, job.record) as prepared:
        plan, fmus, manifest = prepared.plan, prepared.fmus, prepared.manifest(job.needed)
        reason = host.check_resumable(plan, fmus)
        teller.tell(RunRecorder.begin, replace(manifest, not_resumable=reason), answered=True)
        teller.answer()
        outcome = execute(plan, fmus, host, echo=host.logged, logging=job.logging, host=host)
    teller.tell(RunRecorder.notes, outcome.notes)
    if outcome.fault is not None:
        raise StopAskedError if teller.marker.stop[0] else outcome.fault


class _Host(VisibleHost):
    """A run whose clock and rows the supervisor sees."""

    def __init__(self, job: Job, row_memory: int, teller: Teller) -> None:
        super().__init__(teller.marker, teller.send)
        self._job, self._teller, self._descriptor = job, teller, row_memory
        self._memory: RowMemory | None = None
        self._told = 0  # chunks that are done
        self._taken = 0  # chunks whose rows the supervisor has
        self._recorded = 0  # rows
        self._made_of: dict[str, str] | None = None  # None: no checkpoints
        self._program: Program | None = None
        self._begun = False
        self._saved = time.monotonic()
        self._cycles_between = 0  # of two checkpoints; 0: any number

    def linked(self, program: Program) -> None:
        """The program is there."""
        super().linked(program)
        self._program = program

    def check_resumable(self, plan: Plan, fmus: Mapping[str, Fmu]) -> str:
        """Find out whether there can be checkpoints, and why not; refuse one of another run."""
        reason, job = why_not(plan, fmus), self._job
        limits = job.limits
        wanted = (limits.checkpoint, limits.checkpoint_simulated, job.resumed)
        if not reason and any(one is not None for one in wanted):
            self._made_of = made_of(plan, fmus)
        if job.resumed is not None:
            changed = differences(job.resumed.made_of, self._made_of or {})
            if changed:
                raise ExperimentError(
                    f"the run cannot be resumed, since it is not what it was: {', '.join(changed)} "
                    "changed; run it again into another folder"
                )
        return reason

    def logged(self, component: str, message: LogMessage) -> None:
        """An FMU has logged something; with logging, none is lost."""
        messages = self._teller.marker.messages
        due = messages.put(component, message)
        if self._job.logging:
            if due:
                self._teller.tell(RunRecorder.take_messages)
            while messages.full:
                time.sleep(1e-3)

    def chunk_rows(self, columns: int) -> int:
        """More than in one process, since every chunk costs two messages."""
        return max(_LEAST_ROWS, min(_MOST_ROWS, _CHUNK_BYTES // (8 * (1 + columns))))

    def most_rows(self, rows: int, columns: int) -> None:
        """Give the shared memory its size."""
        self._memory = RowMemory(self._descriptor, rows, columns, create=True)
        # events of one FMU may be recorded after later ones of another
        in_order = self._program is not None and len(self._program.events) < 2
        self._teller.tell(RunRecorder.room, rows, columns, in_order)

    def room(self, rows: int, columns: int) -> tuple[Times, Rows]:
        """One half of the memory, after the supervisor has taken what was in it."""
        assert self._memory is not None
        while self._told - self._taken > 1:
            self._teller.answer()
            self._taken += 1
        self._teller.marker.begin_chunk(self._told + 1)
        return self._memory.of(self._told + 1)

    def add_texts(self, new: Sequence[str | bytes]) -> None:
        """Tell them before the rows that name them are there; a run that is resumed has those of
        its checkpoint."""
        if self._begun or self._job.resumed is None:
            self._teller.tell(RunRecorder.texts, tuple(new))

    def append(self, times: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        """A chunk is done; its rows are where the supervisor finds them, if need be in another
        order than before."""
        assert self._memory is not None
        own_times, own_rows = self._memory.of(self._told + 1)
        if not np.shares_memory(times, own_times):
            own_times[: len(times)], own_rows[: len(times)] = times, rows
        self._recorded += len(rows)
        self._told += 1
        self._teller.tell(RunRecorder.chunk, self._told, len(rows), answered=True)

    def begin(self, program: Program) -> int:
        """The first cycle, or that after the checkpoint."""
        self._begun = True
        self._saved = time.monotonic()
        every = self._job.limits.checkpoint_simulated
        if every is not None:  # between cycles, so at least one, and rather too late
            ticks = round(every * self._job.system.ticks_per_second)
            self._cycles_between = -(-ticks // program.plan.cycle_ns)
        notes = tuple(n for p in program.participants.values() for n in p.notes)
        self._teller.tell(RunRecorder.notes, notes)
        snapshot = self._job.resumed
        if snapshot is None:
            return 0
        restore(program, snapshot)
        self.add_texts(snapshot.texts)
        self._recorded = snapshot.rows
        self.clock[CYCLE], self.clock[INSTANT] = snapshot.cycle, snapshot.now_ns
        return snapshot.cycle

    def cycles_until(self, cycle: int) -> int:
        """A chunk ends where a checkpoint is due by simulated time."""
        between = self._cycles_between
        return between - cycle % between if between else super().cycles_until(cycle)

    def between(self, cycle: int) -> None:
        """Save the state where it is time to; end where the supervisor wants it."""
        stop, every = self._teller.marker.stop[0], self._job.limits.checkpoint
        due = every is not None and time.monotonic() - self._saved >= every
        due = due or (self._cycles_between > 0 and cycle % self._cycles_between == 0)
        if due or stop:
            self._save(cycle)
        if stop:
            raise StopAskedError

    def _save(self, cycle: int) -> None:
        if self._program is None or self._made_of is None:
            return
        now = int(self.clock[INSTANT])
        try:
            snapshot = take(self._program, cycle, self._recorded, now, self._made_of)
        except FmuError:  # it promised what it cannot do; the run itself goes on
            self._made_of = None
            return
        self._teller.tell(RunRecorder.checkpoint, snapshot.to_bytes())
        self._saved = time.monotonic()
