"""Any work that calls into FMUs, done in a worker under the same watch as the run of a system.

    value = run_task(work, limits=limits, file=path, hear=print)

`work` gets a `Teller`, by which it sends what shall outlive it while it runs; what it returns comes
back, and what it raises is raised here. Where no worker can be had (not on Linux, or in a worker
already) it is done in this process.

This module refuses to know what the work is.
"""

from __future__ import annotations

import io
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from threading import Lock
from typing import Any, TypeVar

from harness.errors import UsageError
from harness.fmi.binding import mark
from harness.process.fork import WorkerProcess, available
from harness.process.limits import Limits
from harness.process.marker import Marker, Where
from harness.process.messages import Linked, Printed, packed, unpacked
from harness.process.watch import Watch, show

T = TypeVar("T")

Hear = Callable[[Any], None]


class StopAskedError(BaseException):
    """The supervisor wants the work to end."""


class Teller:
    """The worker's way to its supervisor; in one process, straight to `hear`."""

    def __init__(self, hear: Hear) -> None:
        """`hear` takes what is told."""
        self._hear = hear

    def tell(self, content: Any) -> None:
        """Send something picklable; it arrives even where the worker dies the next moment."""
        self._hear(content)

    def logged(self, text: str) -> None:
        """Keep a message of an FMU for the sentence about the worker's death."""

    def show_loops(self) -> None:
        """Let the supervisor see the compiled loops of systems that run from now on."""

    def reached(self, time: float) -> None:
        """Say which simulated time (s) has come; ends the work where the supervisor wants it."""


@dataclass(frozen=True)
class _Told:
    content: Any


@dataclass(frozen=True)
class _Done:
    """`stopped`: it ended since it was asked to; `fault` what went through it."""

    value: Any = None
    fault: bytes = b""
    stopped: bool = False


def run_task(
    work: Callable[[Teller], T],
    *,
    limits: Limits | None = None,
    file: Path | None = None,
    hear: Hear | None = None,
) -> T:
    """What `work` returns. `file`, the FMU that it calls, is named where the worker dies.

    Raises what `work` raises, `SimulationError` where the worker dies or exceeds a limit,
    `KeyboardInterrupt` or `TerminatedError` on Ctrl-C and SIGTERM, and `UsageError` where it is to
    be isolated and cannot be.
    """
    hear = hear or _nobody
    if not available():
        if limits is not None and limits.isolate:
            raise UsageError("isolation needs a worker process of the run's own, on Linux")
        return work(Teller(hear))
    watch = _TaskWatch(limits or Limits(), hear)
    watch.calls.only = file
    watch.follow(lambda connection: _live(work, connection, watch.marker))
    if watch.fault is None and watch.done is not None and watch.done.fault:
        watch.fault = unpacked(watch.done.fault)
    if watch.fault is not None:
        raise watch.fault
    assert watch.done is not None
    value: T = watch.done.value
    return value


def _nobody(content: Any) -> None:
    pass


class _TaskWatch(Watch):
    def __init__(self, limits: Limits, hear: Hear) -> None:
        super().__init__(limits)
        self.hear = hear
        self.done: _Done | None = None

    def take(self, worker: WorkerProcess, message: Any) -> None:
        """Pass on what is told, and note the end."""
        match message:
            case _Told():
                self.hear(message.content)
            case Linked():
                self.calls.linked = message
            case Printed():
                show(message)
            case _Done():
                self.done, self.over, self.stopped = message, True, message.stopped

    def take_late(self, worker: WorkerProcess, message: Any) -> None:
        """What was told before the end still counts, but not that it was over."""
        if not isinstance(message, _Done):
            self.take(worker, message)

    def see(self, where: Where) -> None:
        """Nothing is shown of where it is."""


def _live(work: Callable[[Teller], Any], connection: Connection, marker: Marker) -> None:
    """The worker's side."""
    teller = _Sender(connection, marker)
    sys.stdout = Forward(teller.send, "stdout")
    sys.stderr = Forward(teller.send, "stderr")
    mark.watch(marker.calling)
    try:
        done = _Done(work(teller))
    except StopAskedError:
        done = _Done(stopped=True)
    except BaseException as fault:
        done = _Done(fault=packed(fault))
    sys.stdout.flush()
    sys.stderr.flush()
    teller.send(done)


class _Sender(Teller):
    def __init__(self, connection: Connection, marker: Marker) -> None:
        super().__init__(lambda content: self.send(_Told(content)))
        self._connection, self._marker = connection, marker
        self._sending = Lock()

    def send(self, message: Any) -> None:
        """Send a message; an FMU may log from threads of its own."""
        with self._sending:
            self._connection.send(message)

    def logged(self, text: str) -> None:
        """Write it to the shared memory."""
        self._marker.logged(text)

    def show_loops(self) -> None:
        """Let them write to the shared memory."""
        from harness.process.loops import show_loops

        show_loops(self._marker, self.send)

    def reached(self, time: float) -> None:
        """Write it to the shared memory, and look whether to end."""
        self._marker.reached(time if math.isfinite(time) else 0.0)
        if self._marker.stop_asked:
            raise StopAskedError


class Forward(io.TextIOBase):
    """Text of Python code in a worker, on its way to the caller's own streams, line by line."""

    def __init__(self, send: Callable[[Printed], None], stream: str) -> None:
        """`stream` is "stdout" or "stderr"."""
        self._send, self._stream, self._held = send, stream, ""

    def writable(self) -> bool:
        """Yes."""
        return True

    def write(self, text: str) -> int:
        """Send what is a whole line, keep the rest."""
        self._held += text
        if "\n" in text or len(self._held) > 4096:
            self.flush()
        return len(text)

    def flush(self) -> None:
        """Send what is held."""
        if self._held:
            held, self._held = self._held, ""
            self._send(Printed(self._stream, held))
