"""Watching a worker: from its start to its end, within its limits, whatever it does.

This is what all supervision has in common: the loop over messages, the deadlines, Ctrl-C, and the
sentence where the worker dies. What messages mean is left to those who watch something particular
(`supervisor` for runs of systems, `task` for any other work). Nothing that an FMU does runs in
this process.
"""

from __future__ import annotations

import select
import sys
import tempfile
import time
import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from harness.compiler.machine_code import say_nothing
from harness.errors import SimulationError
from harness.process import sentence
from harness.process.fork import WorkerProcess
from harness.process.interrupts import Interrupts
from harness.process.isolation import isolate, missing
from harness.process.limits import Limits
from harness.process.marker import WORKING, Marker, Where
from harness.process.messages import Printed

_LOOK_SECONDS = 0.05
_GRACE_SECONDS = 0.4  # for a worker that was asked to stop


class Watch(ABC):
    """One worker and what is known of it: `fault` what ended it early, `died` where it did not
    end itself; `over` once it has said that it is done, `stopped` where that was by request."""

    def __init__(self, limits: Limits) -> None:
        """Starts nothing."""
        self.limits = limits
        self.marker = Marker()
        self.calls = sentence.Calls()
        self.fault: BaseException | None = None
        self.died = False
        self.over = False
        self.stopped = False
        self._last: Where | None = None

    @abstractmethod
    def take(self, worker: WorkerProcess, message: Any) -> None:
        """Deal with a message of the worker."""

    @abstractmethod
    def take_late(self, worker: WorkerProcess, message: Any) -> None:
        """Deal with a message that was in the pipe when the worker was gone already."""

    @abstractmethod
    def see(self, where: Where) -> None:
        """Look at where the worker is, every now and then."""

    def follow(self, work: Callable[[Connection], None]) -> None:
        """Start a worker for `work` and watch it to its end; no fault of it is raised."""
        limits = self.limits
        for phrase in missing() if limits.isolate else ():
            warnings.warn(f"the run is isolated in part only: {phrase}", stacklevel=4)

        def inside(connection: Connection) -> None:
            if limits.isolate:
                say_nothing()
                isolate((Path(tempfile.gettempdir()),), limits.memory_bytes)
            work(connection)

        with Interrupts() as interrupts:
            worker = WorkerProcess(inside)
            at_once = True
            try:
                at_once = self._until_over(worker, interrupts)
            except BaseException as fault:  # of a callback; rows are closed before it goes on
                self.fault = fault
            code = worker.end(at_once=at_once)
            self._take_rest(worker)
            worker.connection.close()
        if self.fault is None and not self.over:
            log = self.marker.log_lines()
            self.fault = SimulationError(sentence.death(self.calls, self.marker.where(), code, log))
            self.died = True

    def _until_over(self, worker: WorkerProcess, interrupts: Interrupts) -> bool:
        """Follow the worker to its end; whether it is to be killed at once."""
        self._began = self._moved = looked = time.monotonic()
        stop_by: float | None = None
        arrives = select.poll()  # that of a Connection is made anew for every message
        arrives.register(worker.connection.fileno(), select.POLLIN)
        while not self.over and self.fault is None:
            if arrives.poll(1000.0 * _LOOK_SECONDS):
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
                self._look(worker, now)
            if interrupts.reason and stop_by is None:
                self.marker.ask_to_stop()
                stop_by = now + _GRACE_SECONDS
            if stop_by is not None and now > stop_by:
                break
        if interrupts.reason and not self.over:
            self.fault = self.fault or interrupts.fault()
        elif interrupts.reason and self.stopped:
            self.fault = interrupts.fault()
        return True

    def _look(self, worker: WorkerProcess, now: float) -> None:
        """See whether limits are kept."""
        where = self.marker.where()
        if where != self._last or where.place == WORKING:
            self._last, self._moved = where, now
        self.see(where)
        limits, log = self.limits, self.marker.log_lines()
        held, most = worker.memory(), limits.memory_bytes
        told = ""
        if limits.call is not None and now - self._moved > limits.call:
            told = sentence.overdue(self.calls, where, limits, log)
        elif limits.run is not None and now - self._began > limits.run:
            told = sentence.too_long(self.calls, where, limits)
        elif most is not None and held > most:
            told = sentence.too_big(self.calls, where, held, most, log)
        if told:
            self.fault, self.died = SimulationError(told), True

    def _take_rest(self, worker: WorkerProcess) -> None:
        """The worker is gone: take what it has left in the pipe."""
        with suppress(EOFError, OSError):
            while worker.connection.poll(0):
                self.take_late(worker, worker.connection.recv())


def show(printed: Printed) -> None:
    """Write text of the worker to the stream that it was meant for."""
    with suppress(OSError, ValueError):
        getattr(sys, printed.stream).write(printed.text)
