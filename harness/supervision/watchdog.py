"""For processes of a study, which run many systems without a supervisor each: a thread that ends
the process where a call into an FMU does not come back.

Whoever started the process sees it die and repeats its runs under supervisors, which tell what
happened. This module refuses to report anything itself.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from dataclasses import dataclass

from harness.execution import surroundings
from harness.execution.surroundings import Surroundings
from harness.fmi import mark
from harness.supervision.process import already_isolated


@dataclass
class _Place:
    """Where the process is: calls so far, whether in one, and the loop that runs."""

    calls: int = 0
    in_call: bool = False
    loop: Surroundings | None = None

    def now(self) -> tuple[object, ...] | None:
        """What changes as long as things move; None outside calls and loops."""
        loop = self.loop
        if loop is None and not self.in_call:
            return None
        return self.calls, () if loop is None else tuple(loop.clock.tolist())


_place = _Place()


class _Seen(Surroundings):
    """A run whose loop the watchdog sees."""

    def loop(self, inside: bool) -> None:
        """The loop is entered or left."""
        _place.calls += 1
        _place.loop = self if inside else None


def _calling(component: str, call: str) -> None:
    _place.calls += 1
    _place.in_call = bool(call)


def watch_over_calls(seconds: float) -> None:
    """From now on this process ends itself where a call takes longer than that."""
    already_isolated()
    mark.watch(_calling)
    surroundings.usual = _Seen
    threading.Thread(target=_watch, args=(seconds,), daemon=True).start()


def _watch(seconds: float) -> None:
    last, since = _place.now(), time.monotonic()
    while True:
        time.sleep(min(0.5, seconds / 4))
        current, now = _place.now(), time.monotonic()
        if current is None or current != last:
            last, since = current, now
        elif now - since > seconds:
            os.kill(os.getpid(), signal.SIGKILL)
