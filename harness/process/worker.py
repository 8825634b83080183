"""What happens in the worker: open, plan, execute, and tell the supervisor.

It writes no file of its own but what FMUs are unpacked to, and decides nothing: rows, faults and
the state for checkpoints go to the supervisor.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from multiprocessing.connection import Connection
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compiler.operations import CYCLE, INSTANT
from harness.errors import ExperimentError, FmuError
from harness.fmi.binding import mark
from harness.fmi.binding.logger import LogMessage
from harness.fmi.fmu import Fmu
from harness.fmi.wording import shorten
from harness.master.host import Host, Rows, Times
from harness.master.opened import opened
from harness.master.plan.planner import Plan
from harness.master.prepared import check_needed
from harness.master.program.link import Program
from harness.master.recorded import columns_of
from harness.master.run import execute, plan_system
from harness.process.checkpoint import differences, made_of, restore, take, why_not
from harness.process.loops import linked_program
from harness.process.marker import Marker, RowMemory
from harness.process.messages import (
    Checkpoint,
    Chunk,
    Ended,
    Heard,
    Job,
    Planned,
    Room,
    Texts,
    packed,
)
from harness.process.task import Forward, StopAskedError
from harness.results.manifest import FmuRecord

_LEAST_ROWS, _MOST_ROWS = 4096, 32768
_CHUNK_BYTES = 2**23  # memory fresh from the system is slow to touch, and here both sides do


def work(job: Job, connection: Connection, marker: Marker, row_memory: int) -> None:
    """Run `job` to its end and tell it; `row_memory` is the descriptor of the rows' memory."""
    sys.stdout = Forward(connection.send, "stdout")
    sys.stderr = Forward(connection.send, "stderr")
    mark.watch(marker.calling)
    try:
        ended = _run(job, _Watched(job, connection, marker, row_memory))
    except StopAskedError:
        ended = Ended()
    except BaseException as fault:
        ended = Ended(fault=packed(fault))
    sys.stdout.flush()
    sys.stderr.flush()
    connection.send(ended)


def _run(job: Job, around: _Watched) -> Ended:
    with opened(job.system) as fmus:
        plan = plan_system(job.system, fmus, job.record)
        columns = columns_of(plan, fmus)
        check_needed(job.needed, columns)
        records = tuple(FmuRecord(n, fmu.path.name, fmu.sha256) for n, fmu in fmus.items())
        files = {name: fmu.path for name, fmu in fmus.items()}
        reason = around.plan(plan, fmus)
        around.tell(Planned(columns, records, files, reason, plan.notes))
        around.hear()
        outcome = execute(plan, fmus, around, echo=around.heard, logging=job.logging, host=around)
    if outcome.fault is None:
        return Ended(outcome)
    return Ended(replace(outcome, fault=None), packed(outcome.fault))


class _Watched(Host):
    """A run whose clock and rows the supervisor sees."""

    def __init__(self, job: Job, connection: Connection, marker: Marker, row_memory: int) -> None:
        self.clock = marker.clock
        self.reached, self.stop_asked = marker.time, marker.stop
        self._job = job
        self._connection = connection
        self._marker = marker
        self._descriptor = row_memory
        self._memory: RowMemory | None = None
        self._begun = 0  # chunks begun, which is also the number of the present one
        self._taken = 0  # chunks whose rows the supervisor has
        self._telling = Lock()
        self._recorded = 0
        self._made_of: dict[str, str] | None = None  # None: no checkpoints
        self._live: Program | None = None
        self._saved = time.monotonic()
        self._apart = 0  # cycles between checkpoints; 0: any number

    def tell(self, message: Any) -> None:
        """Send a message to the supervisor; an FMU may log from threads of its own."""
        with self._telling:
            self._connection.send(message)

    def hear(self) -> Any:
        """Wait for the supervisor."""
        return self._connection.recv()

    def plan(self, plan: Plan, fmus: Mapping[str, Fmu]) -> str:
        """Find out whether there can be checkpoints, and why not; refuse one of another run."""
        interfaces = {name: fmu.description.co_simulation for name, fmu in fmus.items()}
        can = {name: i is not None and i.can_serialize_fmu_state for name, i in interfaces.items()}
        reason = why_not(plan, can)
        job = self._job
        wanted = job.every is not None or job.every_ns is not None or job.resumed is not None
        if wanted and not reason:
            self._made_of = made_of(plan, {name: fmu.sha256 for name, fmu in fmus.items()})
        if self._job.resumed is not None:
            changed = differences(self._job.resumed.made_of, self._made_of or {})
            if changed:
                raise ExperimentError(
                    f"the run cannot be resumed, since it is not what it was: {', '.join(changed)} "
                    "changed; run it again into another folder"
                )
        return reason

    def heard(self, component: str, message: LogMessage) -> None:
        """An FMU has logged something."""
        self._marker.logged(f"{component}: {shorten(message.text, 300)}")
        if self._job.logging:
            self.tell(Heard(component, message))

    def chunk_rows(self, columns: int) -> int:
        """More than in one process, since every chunk costs two messages."""
        return max(_LEAST_ROWS, min(_MOST_ROWS, _CHUNK_BYTES // (8 * (1 + columns))))

    def most_rows(self, rows: int, columns: int) -> None:
        """Give the shared memory its size."""
        self._memory = RowMemory(self._descriptor, rows, columns, create=True)
        self.tell(Room(rows, columns))

    def room(self, rows: int, columns: int) -> tuple[Times, Rows]:
        """One half of the memory, after the supervisor has taken what was in it."""
        assert self._memory is not None
        while self._begun - self._taken > 1:
            self._taken = self.hear()
        half = self._begun % 2
        self._begun += 1
        self._marker.begin_chunk(self._begun)
        return self._memory.times[half], self._memory.values[half]

    def add_texts(self, new: Sequence[str | bytes]) -> None:
        """Tell them before the rows that name them are there."""
        self.tell(Texts(tuple(new)))

    def append(self, times: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        """A chunk is done; its rows are where the supervisor finds them."""
        self._recorded += len(rows)
        self.tell(Chunk(self._begun, len(rows)))

    def linked(self, program: Program) -> None:
        """Tell what each operation of the program is."""
        self.tell(linked_program(program))

    def begin(self, program: Program) -> int:
        """The first cycle, or that after the checkpoint."""
        self._live = program
        self._saved = time.monotonic()
        self._apart = _cycles_apart(self._job.every_ns, program.plan.cycle_ns)
        snapshot = self._job.resumed
        if snapshot is None:
            return 0
        restore(program, snapshot)
        self._recorded = snapshot.rows
        self.clock[CYCLE], self.clock[INSTANT] = snapshot.cycle, snapshot.now_ns
        return snapshot.cycle

    def loop(self, inside: bool) -> None:
        """Mark that the loop runs."""
        self._marker.looping(inside)

    def cycles_until(self, cycle: int) -> int:
        """A chunk ends where a checkpoint is due by simulated time."""
        return self._apart - cycle % self._apart if self._apart else super().cycles_until(cycle)

    def between(self, cycle: int) -> None:
        """Save the state where it is time to; end where the supervisor wants it."""
        stop = self._marker.stop_asked
        due = self._job.every is not None and time.monotonic() - self._saved >= self._job.every
        due = due or (self._apart > 0 and cycle % self._apart == 0)
        if self._made_of is not None and (due or stop):
            self._save(cycle)
        if stop:
            raise StopAskedError

    def _save(self, cycle: int) -> None:
        assert self._live is not None and self._made_of is not None
        now = int(self.clock[INSTANT])
        try:
            snapshot = take(self._live, cycle, self._recorded, now, self._made_of)
        except FmuError:  # it promised what it cannot do; the run itself goes on
            self._made_of = None
            return
        self.tell(Checkpoint(snapshot.to_bytes()))
        self._saved = time.monotonic()


def _cycles_apart(every_ns: int | None, cycle_ns: int) -> int:
    """Checkpoints are taken between cycles, so at least one, and rather too late."""
    return 0 if every_ns is None else -(-every_ns // cycle_ns)
