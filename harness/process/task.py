"""Work that calls into FMUs, done in a worker.

    value = run_task(work, limits=limits, file=path)

`work` gets a `Teller`, by which it says how far it is while it runs; what it returns comes back,
and what it raises is raised here. Where no worker can be had (not on Linux, or in a worker
already) it is done in this process.

This module refuses to know what the work is; the run of a system (`run`) is one.
"""

from __future__ import annotations

import io
import math
import sys
from collections.abc import Callable
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from threading import Lock
from typing import Any, TypeVar

from harness.errors import UsageError
from harness.fmi.binding import mark
from harness.process.fork import available
from harness.process.limits import Limits
from harness.process.marker import Marker
from harness.process.messages import Done, Linked, Printed, Told, packed
from harness.process.watch import Watch

T = TypeVar("T")


class StopAskedError(BaseException):
    """The supervisor wants the work to end."""


class Teller:
    """The worker's way to its supervisor; what is told without a `connection` is lost."""

    def __init__(self, marker: Marker, connection: Connection | None = None) -> None:
        """`marker` is the memory that the supervisor sees."""
        self.marker, self._connection = marker, connection
        self._sending = Lock()

    def tell(self, method: Callable[..., Any], *arguments: Any, answered: bool = False) -> None:
        """Have a method called of whoever receives what is told, with arguments that can be
        pickled; it arrives even where the worker dies the next moment."""
        self.send(Told(method, arguments, answered))

    def answer(self) -> Any:
        """Wait for the answer to the first `answered` call that has none yet."""
        assert self._connection is not None
        return self._connection.recv()

    def send(self, message: Told | Printed | Linked | Done) -> None:
        """Send a message; an FMU may log from threads of its own."""
        if self._connection is not None:
            with self._sending:
                self._connection.send(message)

    def show_loops(self) -> None:
        """Let the supervisor see the compiled loops of systems that run from now on."""
        if self._connection is not None:
            from harness.master import host
            from harness.process.loops import VisibleHost

            host.usual = partial(VisibleHost, self.marker, self.send)

    def reached(self, time: float) -> None:
        """Say which simulated time (s) has come; ends the work where the supervisor wants it."""
        self.marker.time[0] = time if math.isfinite(time) else 0.0
        if self.marker.stop[0]:
            raise StopAskedError


def run_task(
    work: Callable[[Teller], T], *, limits: Limits | None = None, file: Path | None = None
) -> T:
    """What `work` returns. `file`, the FMU that it calls, is named where the worker dies.

    Raises what `work` raises, `SimulationError` where the worker dies or exceeds a limit,
    `KeyboardInterrupt` or `TerminatedError` on Ctrl-C and SIGTERM, and `UsageError` where it is to
    be isolated and cannot be.
    """
    if not available():
        if limits is not None and limits.isolate:
            raise UsageError("isolation needs a worker process of the run's own, on Linux")
        return work(Teller(Marker()))
    watch = Watch(limits or Limits(), marker := Marker(), files=file)
    watch.follow(partial(live, work, marker))
    if watch.fault is not None:
        raise watch.fault
    assert watch.done is not None
    value: T = watch.done.value
    return value


def live(work: Callable[[Teller], Any], marker: Marker, connection: Connection) -> None:
    """The worker's side."""
    teller = Teller(marker, connection)
    sys.stdout, sys.stderr = (Forward(teller.send, name) for name in ("stdout", "stderr"))
    mark.watch(marker.calling)
    try:
        done = Done(work(teller))
    except StopAskedError:
        done = Done(stopped=True)
    except BaseException as fault:
        done = Done(fault=packed(fault))
    sys.stdout.flush()
    sys.stderr.flush()
    teller.send(done)


class Forward(io.TextIOBase):
    """Text of Python code in a worker, on its way to the caller's own streams, line by line."""

    def __init__(self, send: Callable[[Printed], object], stream: str) -> None:
        """`stream` is "stdout" or "stderr"."""
        self._send, self._stream, self._unsent = send, stream, ""

    def writable(self) -> bool:
        """Yes."""
        return True

    def write(self, text: str) -> int:
        """Send what is a whole line, keep the rest."""
        self._unsent += text
        if "\n" in text or len(self._unsent) > 4096:
            self.flush()
        return len(text)

    def flush(self) -> None:
        """Send what is held."""
        if self._unsent:
            text, self._unsent = self._unsent, ""
            self._send(Printed(self._stream, text))
