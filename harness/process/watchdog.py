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

from harness.fmi.binding import mark
from harness.master import host as hosts
from harness.process.fork import already_isolated, memory_of
from harness.process.limits import Deadlines, Limits
from harness.process.loops import VisibleHost
from harness.process.marker import WORKING, Marker

_marker = Marker()
_run = Deadlines(Limits())


class _WatchedHost(VisibleHost):
    """A run whose loop the watchdog sees, and which begins now."""

    def __init__(self) -> None:
        super().__init__(_marker)
        allow(_run.limits)


def watch_over_runs() -> None:
    """From now on this process ends itself where a run exceeds what `allow` has said last."""
    already_isolated()
    mark.watch(_marker.calling)
    hosts.usual = _WatchedHost
    threading.Thread(target=_watch, daemon=True).start()


def allow(limits: Limits) -> None:
    """The limits of the runs to come; they count only where runs are watched over."""
    global _run
    _run = Deadlines(limits)


def _watch() -> None:
    while True:
        run = _run
        spans = (run.limits.call, run.limits.run)
        time.sleep(min([0.5, *(each / 4 for each in spans if each is not None)]))
        where = _marker.where()
        if run.exceeded(where, memory_of(os.getpid())) and where.place != WORKING:
            os.kill(os.getpid(), signal.SIGKILL)
