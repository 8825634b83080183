"""The supervisor: starts a worker, takes its rows, enforces limits, tells how it ended.

It writes the recording, so rows outlive the worker whatever happens to it: they are in shared
memory as soon as the loop has written them, and on disk at most `_LOOK_SECONDS` and a chunk's
handling later. Nothing that an FMU does runs in this process.
"""

from __future__ import annotations

import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from os import close
from pathlib import Path
from typing import Any

from harness.errors import HarnessError, SimulationError
from harness.execution.machine_code import say_nothing
from harness.execution.prepared import Echo
from harness.execution.run import Outcome, Progress
from harness.results.recording import Recording
from harness.supervision import sentence
from harness.supervision.checkpoint import write_checkpoint
from harness.supervision.interrupts import Interrupts
from harness.supervision.isolation import isolate, missing
from harness.supervision.limits import Limits
from harness.supervision.marker import WORKING, Marker, RowMemory, Where, shared_file
from harness.supervision.messages import (
    Checkpoint,
    Chunk,
    Ended,
    Heard,
    Job,
    Linked,
    Planned,
    Printed,
    Room,
    unpacked,
)
from harness.supervision.process import WorkerProcess
from harness.supervision.warm import warm_up
from harness.supervision.worker import work

_LOOK_SECONDS = 0.05
_GRACE_SECONDS = 0.4  # for a worker that was asked to stop

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
    watch = _Watch(limits, open_recording, progress, echo)
    marker = watch.marker
    for phrase in missing() if limits.isolate else ():
        warnings.warn(f"the run is isolated in part only: {phrase}", stacklevel=2)
    warm_up(job.system)
    with Interrupts() as interrupts:
        worker = WorkerProcess(partial(_work, job, marker, watch.descriptor, limits))
        at_once = True
        try:
            at_once = watch.until_over(worker, interrupts)
        except BaseException as fault:  # of a callback; the rows are closed before it goes on
            watch.found.fault = fault
        code = worker.end(at_once=at_once)
        watch.take_rest(worker)
        worker.connection.close()
        close(watch.descriptor)
    return watch.verdict(code)


def _work(job: Job, marker: Marker, descriptor: int, limits: Limits, connection: Any) -> None:
    if limits.isolate:
        say_nothing()
        isolate((Path(tempfile.gettempdir()),), limits.memory_bytes)
    work(job, connection, marker, descriptor)


@dataclass
class _Watch:
    limits: Limits
    open_recording: OpenRecording
    progress: Progress | None
    echo: Echo | None
    marker: Marker = field(default_factory=Marker)
    descriptor: int = field(default_factory=lambda: shared_file(0))
    calls: sentence.Calls = field(default_factory=sentence.Calls)
    found: Supervised = field(default_factory=Supervised)
    memory: RowMemory | None = None
    chunk: int = 1  # under way
    taken: int = 0  # rows of it that are recorded
    ended: Ended | None = None
    last: Where | None = None

    def until_over(self, worker: WorkerProcess, interrupts: Interrupts) -> bool:
        """Follow the worker to its end; whether it is to be killed at once."""
        self.began = self.moved = looked = time.monotonic()
        stop_by: float | None = None
        while self.ended is None and self.found.fault is None:
            if worker.connection.poll(_LOOK_SECONDS):
                try:
                    message = worker.connection.recv()
                except (EOFError, OSError):
                    return False
                self.take(worker, message)
            elif worker.gone() and not worker.connection.poll(0):
                return False
            now = time.monotonic()
            if now - looked >= _LOOK_SECONDS:
                looked = now
                self.look(worker, now)
            if interrupts.reason and stop_by is None:
                self.marker.ask_to_stop()
                stop_by = now + _GRACE_SECONDS
            if stop_by is not None and now > stop_by:
                break
        if interrupts.reason and self.ended is None:
            self.found.fault = self.found.fault or interrupts.fault()
        elif interrupts.reason and self.ended is not None and self.ended.outcome is None:
            self.found.fault = interrupts.fault()
        return True

    def take(self, worker: WorkerProcess, message: Any) -> None:
        """Deal with a message of the worker."""
        match message:
            case Planned():
                self.calls.files = message.files
                try:
                    self.found.recording = self.open_recording(message)
                except HarnessError as fault:
                    self.found.fault = fault
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
            case Checkpoint() if self.found.recording is not None:
                self.save(self.found.recording, message.content)
            case Heard():
                if self.echo is not None:
                    self.echo(message.component, message.message)
            case Printed():
                with suppress(OSError, ValueError):
                    getattr(sys, message.stream).write(message.text)
            case Ended():
                self.ended = message

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
        if self.memory is None or self.found.recording is None or there <= self.taken:
            return
        half, part = (self.chunk - 1) % 2, slice(self.taken, there)
        try:
            self.found.recording.append(
                self.memory.times[half][part], self.memory.values[half][part]
            )
        except HarnessError as fault:
            self.found.fault = self.found.fault or fault
            self.memory = None
        self.taken = there

    def look(self, worker: WorkerProcess, now: float) -> None:
        """Take rows that are there, show progress, and see whether limits are kept."""
        self.record(self.marker.rows(self.chunk) - 1)  # the newest may be half written
        where = self.marker.where()
        if where != self.last or where.place == WORKING:
            self.last, self.moved = where, now
        if self.progress is not None and self.calls.linked is not None:
            self.progress(min(1.0, where.cycle / self.calls.linked.cycles))
        limits, log = self.limits, self.marker.log_lines()
        held, most = worker.memory(), limits.memory_bytes
        told = ""
        if limits.call is not None and now - self.moved > limits.call:
            told = sentence.overdue(self.calls, where, limits, log)
        elif limits.run is not None and now - self.began > limits.run:
            told = sentence.too_long(self.calls, where, limits)
        elif most is not None and held > most:
            told = sentence.too_big(self.calls, where, held, most, log)
        if told:
            self.found.fault, self.found.died = SimulationError(told), True

    def take_rest(self, worker: WorkerProcess) -> None:
        """The worker is gone: take what it has left in the pipe and in the shared memory."""
        with suppress(EOFError, OSError):
            while worker.connection.poll(0):
                message = worker.connection.recv()
                if isinstance(message, (Chunk, Printed, Checkpoint)):
                    self.take(worker, message)
        self.record(self.marker.rows(self.chunk))

    def verdict(self, code: int | None) -> Supervised:
        """How it ended, in all."""
        found, ended = self.found, self.ended
        if found.fault is None and ended is None:
            told = sentence.death(self.calls, self.marker.where(), code, self.marker.log_lines())
            found.fault, found.died = SimulationError(told), True
        elif found.fault is None and ended is not None:
            found.outcome = ended.outcome
            found.fault = unpacked(ended.fault) if ended.fault else None
            if self.progress is not None and found.fault is None:
                self.progress(1.0)
        return found
