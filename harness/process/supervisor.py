"""The supervisor: starts a worker, takes its rows, enforces limits, tells how it ended.

It writes the recording, so rows outlive the worker whatever happens to it: they are in shared
memory as soon as the loop has written them, and on disk a moment and a chunk's handling later.
Nothing that an FMU does runs in this process.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from os import close
from typing import Any

from harness.errors import HarnessError
from harness.master.prepared import Echo
from harness.master.run import Outcome, Progress
from harness.process.checkpoint import write_checkpoint
from harness.process.fork import WorkerProcess
from harness.process.limits import Limits
from harness.process.marker import RowMemory, Where, shared_file
from harness.process.messages import (
    Checkpoint,
    Chunk,
    Ended,
    Heard,
    Job,
    Linked,
    Planned,
    Printed,
    Room,
    Texts,
    unpacked,
)
from harness.process.warm import warm_up
from harness.process.watch import Watch, show
from harness.process.worker import work
from harness.results.recording import Recording

OpenRecording = Callable[[Planned], Recording]
"""Opens the recording of a run whose columns and FMUs are known."""


@dataclass
class Supervised:
    """How a run ended: `recording` None where it never began; `fault` what ended it early;
    `died`: the worker did not end it itself."""

    recording: Recording | None = None
    outcome: Outcome | None = None
    fault: BaseException | None = None
    died: bool = False


def supervise(
    job: Job,
    limits: Limits,
    open_recording: OpenRecording,
    *,
    progress: Progress | None = None,
    echo: Echo | None = None,
) -> Supervised:
    """Run `job` in a worker; the recording is left open. No fault of the run is raised."""
    watch = _RunWatch(limits, open_recording, progress, echo)
    warm_up(job.system)
    try:
        watch.follow(
            partial(_work, job, watch.marker, watch.descriptor),
        )
        watch.record(watch.marker.rows(watch.chunk))
    finally:
        close(watch.descriptor)
    return watch.verdict()


def _work(job: Job, marker: Any, descriptor: int, connection: Any) -> None:
    work(job, connection, marker, descriptor)


class _RunWatch(Watch):
    """Watches the run of a system; `chunk` is the one under way, `taken` its rows recorded."""

    def __init__(
        self,
        limits: Limits,
        open_recording: OpenRecording,
        progress: Progress | None,
        echo: Echo | None,
    ) -> None:
        super().__init__(limits)
        self.open_recording = open_recording
        self.progress, self.echo = progress, echo
        self.descriptor = shared_file(0)
        self.memory: RowMemory | None = None
        self.recording: Recording | None = None
        self.chunk, self.taken = 1, 0
        self.ended: Ended | None = None

    def take(self, worker: WorkerProcess, message: Any) -> None:
        """Deal with a message of the worker."""
        match message:
            case Planned():
                self.calls.files = message.files
                try:
                    self.recording = self.open_recording(message)
                except HarnessError as fault:
                    self.fault = fault
                    return
                worker.tell("go")
            case Room():
                self.memory = RowMemory(self.descriptor, message.rows, message.columns)
            case Linked():
                self.calls.linked = message
            case Chunk():
                self.record(message.rows)
                self.chunk, self.taken = message.number + 1, 0
                worker.tell(message.number)
            case Texts() if self.recording is not None:
                self.recording.add_texts(message.new)
            case Checkpoint() if self.recording is not None:
                self.save(self.recording, message.content)
            case Heard():
                if self.echo is not None:
                    self.echo(message.component, message.message)
            case Printed():
                show(message)
            case Ended():
                self.ended, self.over = message, True
                self.stopped = message.outcome is None

    def take_late(self, worker: WorkerProcess, message: Any) -> None:
        """What tells of rows and words still counts."""
        if isinstance(message, (Chunk, Printed, Checkpoint, Texts)):
            self.take(worker, message)

    def save(self, recording: Recording, content: bytes) -> None:
        """Write a checkpoint; where the disk is full the run goes on with the one before it."""
        try:
            recording.sync()
            if recording.folder is not None:
                write_checkpoint(recording.folder, content)
        except HarnessError as fault:
            warnings.warn(str(fault), stacklevel=2)

    def record(self, there: int) -> None:
        """Record the rows of the chunk under way up to number `there`."""
        if self.memory is None or self.recording is None or there <= self.taken:
            return
        half, part = (self.chunk - 1) % 2, slice(self.taken, there)
        try:
            self.recording.append(self.memory.times[half][part], self.memory.values[half][part])
        except HarnessError as fault:
            self.fault = self.fault or fault
            self.memory = None
        self.taken = there

    def see(self, where: Where) -> None:
        """Take rows that are there, show progress. Rows with texts wait for the end of their chunk,
        when all of their texts have come."""
        if self.recording is not None and not any(c.dtype is None for c in self.recording.columns):
            self.record(self.marker.rows(self.chunk) - 1)  # the newest may be half written
        if self.progress is not None and self.calls.linked is not None:
            self.progress(min(1.0, where.cycle / self.calls.linked.cycles))

    def verdict(self) -> Supervised:
        """How it ended, in all."""
        found = Supervised(self.recording, None, self.fault, self.died)
        if found.fault is None and self.ended is not None:
            found.outcome = self.ended.outcome
            found.fault = unpacked(self.ended.fault) if self.ended.fault else None
            if self.progress is not None and found.fault is None:
                self.progress(1.0)
        return found
