"""Watching a worker: from its start to its end, within its limits, whatever it does.

The loop over messages, the deadlines, Ctrl-C, and the sentence where the worker dies. What is told
goes to whoever started the work. Nothing that an FMU does runs in this process.
"""

from __future__ import annotations

import select
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Mapping
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from harness.compiler.machine_code import say_nothing
from harness.errors import SimulationError
from harness.interrupts import Interrupts
from harness.process import sentence
from harness.process.fork import WorkerProcess
from harness.process.isolation import isolate, missing
from harness.process.limits import Deadlines, Limits
from harness.process.marker import Marker
from harness.process.messages import Done, Linked, Printed, Told, unpacked

_LOOK_SECONDS = 0.05
_GRACE_SECONDS = 0.4  # for a worker that was asked to stop

Look = Callable[[float], None]
"""Called every now and then while a worker lives, with the share of its loop's cycles done."""


class Watch:
    """One worker and what is known of it: `done` is its last message, None where it sent none,
    `fault` what ended the work early, `died` whether that was not the work itself: `exceeded` is
    the limit beyond which the worker was ended, else `code` its exit code, or minus its signal."""

    def __init__(
        self,
        limits: Limits,
        marker: Marker,
        receiver: Any = None,
        look: Look | None = None,
        files: Mapping[str, Path] | Path | None = None,
    ) -> None:
        """Starts nothing. What is told are calls of methods of `receiver`; `files` are the FMUs, by
        component, or the only one."""
        self.limits, self.marker = limits, marker
        self.fault: BaseException | None = None
        self.done: Done | None = None
        self.died, self.exceeded = False, ""
        self.code: int | None = None
        self._receiver, self._notice = receiver, look
        self._calls = sentence.Calls(files)

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
            except BaseException as fault:  # results are closed before it goes on
                self.fault = self.fault or fault
            code = worker.end(at_once=at_once)
            with suppress(EOFError, OSError):
                while worker.connection.poll(0):
                    self._take(worker, worker.connection.recv())
            worker.connection.close()
        if self.fault is None and self.done is None:
            where, log = self.marker.where(), self.marker.messages.last()
            self.fault = SimulationError(sentence.death(self._calls, where, code, log))
            self.died, self.code = True, code
        elif self.fault is None and self.done is not None and self.done.fault:
            self.fault = unpacked(self.done.fault)

    def attempt(self, action: Callable[..., Any], *arguments: Any) -> Any:
        """What it returns; what it raises ends the work."""
        try:
            return action(*arguments)
        except BaseException as fault:
            self.fault = self.fault or fault

    def _until_over(self, worker: WorkerProcess, interrupts: Interrupts) -> bool:
        """Follow the worker to its end; whether it is to be killed at once."""
        deadlines, looked = Deadlines(self.limits), time.monotonic()
        stop_by: float | None = None
        arrives = select.poll()  # that of a Connection is made anew for every message
        arrives.register(worker.connection.fileno(), select.POLLIN)
        while self.done is None and self.fault is None:
            if arrives.poll(1000.0 * _LOOK_SECONDS):
                try:
                    message = worker.connection.recv()
                except (EOFError, OSError):
                    return False
                self._take(worker, message)
            elif worker.gone() and not worker.connection.poll(0):
                return False
            now = time.monotonic()
            if now - looked >= _LOOK_SECONDS:
                looked = now
                self._look(worker, deadlines)
            if interrupts.reason and stop_by is None:
                self.marker.stop[0] = 1
                stop_by = now + _GRACE_SECONDS
            if stop_by is not None and now > stop_by:
                break
        if interrupts.reason and (self.done is None or self.done.stopped):
            self.fault = self.fault or interrupts.fault()
        return True

    def _take(self, worker: WorkerProcess, message: Any) -> None:
        match message:
            case Told():
                answer = self.attempt(message.method, self._receiver, *message.arguments)
                if message.answered:
                    with suppress(OSError):  # the worker is gone
                        worker.connection.send(answer)
            case Linked():
                self._calls.linked = message
            case Printed():
                with suppress(OSError, ValueError):
                    getattr(sys, message.stream).write(message.text)
            case Done():
                self.done = message

    def _look(self, worker: WorkerProcess, deadlines: Deadlines) -> None:
        """See how far the worker is, and whether limits are kept."""
        where, held, linked = self.marker.where(), worker.held(), self._calls.linked
        if self._notice is not None:
            self.attempt(self._notice, min(1.0, where.cycle / linked.cycles) if linked else 0.0)
        if limit := deadlines.exceeded(where, held):
            self.exceeded, log = limit, self.marker.messages.last()
            told = sentence.excess(limit, self._calls, where, self.limits, held, log)
            self.fault, self.died = SimulationError(told), True
