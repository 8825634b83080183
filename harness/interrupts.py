"""Ctrl-C and termination during a run: noted, so that no callback loses them and the rows are
closed first."""

from __future__ import annotations

import signal
import threading
from types import FrameType
from typing import Any, Self

INTERRUPTED = "interrupted by Ctrl-C"


class TerminatedError(SystemExit):
    """The process was asked to end by SIGTERM; its exit code says so. `result` holds the rows so
    far, or None where there are none to give."""

    result: Any = None


class Interrupts:
    """While open, SIGINT and SIGTERM set `reason` instead of what they did, and do that as well
    when they come again. Python delivers signals to the main thread; elsewhere nothing is
    changed."""

    def __init__(self) -> None:
        self.reason = ""
        self._number = 0
        self._untaken = 0
        self._before: dict[int, Any] = {}

    def take(self) -> int:
        """The number of a signal that came since this was asked last; 0: none did."""
        number, self._untaken = self._untaken, 0
        return number

    def fault(self) -> BaseException:
        """What to raise for it."""
        if self._number == signal.SIGTERM:
            return TerminatedError(128 + self._number)
        return KeyboardInterrupt(self.reason)

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                before = signal.getsignal(number)
                if before not in (signal.SIG_IGN, None):
                    self._before[number] = before
                    signal.signal(number, self._note)
        return self

    def __exit__(self, *_: object) -> None:
        for number, before in self._before.items():
            signal.signal(number, before)

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self.reason:
            signal.signal(number, self._before[number])
            signal.raise_signal(number)
        self._number = self._untaken = number
        self.reason = INTERRUPTED if number == signal.SIGINT else "ended by SIGTERM"
