"""For processes of a study, which run many systems without a supervisor each: a thread that ends
the process where a run exceeds its limits: a call into an FMU does not come back, the run takes too
long, or the process holds too much memory.

Whoever started the process sees it die and repeats its runs under supervisors, which tell what
happened. This module refuses to report anything itself.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from dataclasses import dataclass, field

from harness.fmi.binding import mark
from harness.master import host as hosts
from harness.master.host import Host
from harness.process.fork import already_isolated, memory_of
from harness.process.limits import Limits


@dataclass
class _Place:
    """Where the process is: calls so far, whether in one, the loop that runs, and when the last run
    began; `limits` are those of the runs to come."""

    calls: int = 0
    in_call: bool = False
    loop: Host | None = None
    began: float = 0.0
    limits: Limits = field(default_factory=Limits)

    def now(self) -> tuple[object, ...] | None:
        """What changes as long as things move; None outside calls and loops."""
        loop = self.loop
        if loop is None and not self.in_call:
            return None
        return self.calls, () if loop is None else tuple(loop.clock.tolist())


_place = _Place()


class _Seen(Host):
    """A run whose loop the watchdog sees."""

    def __init__(self) -> None:
        super().__init__()
        _place.began = time.monotonic()

    def loop(self, inside: bool) -> None:
        """The loop is entered or left."""
        _place.calls += 1
        _place.loop = self if inside else None


def _calling(component: str, call: str) -> None:
    _place.calls += 1
    _place.in_call = bool(call)


def watch_over_runs() -> None:
    """From now on this process ends itself where a run exceeds what `allow` has said last."""
    already_isolated()
    mark.watch(_calling)
    hosts.usual = _Seen
    threading.Thread(target=_watch, daemon=True).start()


def allow(limits: Limits) -> None:
    """The limits of the runs to come; they count only where runs are watched over."""
    _place.limits = limits


def _watch() -> None:
    last, since = _place.now(), time.monotonic()
    while True:
        limits = _place.limits
        time.sleep(
            min([0.5, *(each / 4 for each in (limits.call, limits.run) if each is not None)])
        )
        current, now = _place.now(), time.monotonic()
        if current is None or current != last:
            last, since = current, now
        if current is not None and _exceeded(limits, now - since, now - _place.began):
            os.kill(os.getpid(), signal.SIGKILL)


def _exceeded(limits: Limits, call: float, run: float) -> bool:
    """Whether a call, a run or the process is beyond its limits."""
    if limits.call is not None and call > limits.call:
        return True
    if limits.run is not None and run > limits.run:
        return True
    most = limits.memory_bytes
    return most is not None and memory_of(os.getpid()) > most
