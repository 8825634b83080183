"""Memory that worker and supervisor share: where the worker is, and the rows not yet taken.

The loop keeps its clock (cycle, instant, rows, operation) in it and writes its rows into it, so
the supervisor sees both without the loop doing anything for it, and has them after the worker's
death. Calls outside the loop write their name. The memory has no name in any file system; it is
gone with the last process that holds it.
"""

from __future__ import annotations

import mmap
import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compiler.operations import CLOCK_SIZE, CYCLE, INSTANT, OPERATION, ROWS
from harness.fmi.binding.logger import LONGEST_MESSAGE, LogMessage
from harness.fmi.wording import shorten

_LOG_LINES = 3
_MESSAGES, _MESSAGE_BYTES = 2048, LONGEST_MESSAGE + 512
_PAGE = np.dtype(
    [(name, np.int64) for name in ("sequence", "place", "chunk", "stop", "function")]
    + [("clock", np.int64, CLOCK_SIZE), ("time", np.float64)]
    + [("component", "S256"), ("call", "S512")]
)

WORKING, CALLING, LOOPING = range(3)
"""What the worker does: Python of ours, a call into an FMU outside the loop, the loop."""


@dataclass(frozen=True)
class Where:
    """What the worker was doing: `component` and `call` where it is in a call outside the loop,
    `operation` where it is in the loop; `now_ns` is the loop's time, `reached` that of a
    simulation without the loop (s; None: there is none). Two equal ones mean that nothing has
    moved."""

    place: int
    sequence: int
    component: str
    call: str
    cycle: int
    now_ns: int
    operation: int
    reached: float | None = None
    function: int = 0


def shared_file(size: int) -> int:
    """A descriptor of `size` bytes of memory without a name."""
    descriptor = os.memfd_create("fmu-harness", os.MFD_CLOEXEC)
    os.ftruncate(descriptor, size)
    return descriptor


class MessageRing:
    """The last messages of FMUs in shared memory, so that a worker's death loses none."""

    def __init__(self) -> None:
        self._memory = mmap.mmap(-1, _MESSAGES * _MESSAGE_BYTES)
        shared = memoryview(mmap.mmap(-1, 8 * (2 + _MESSAGES))).cast("q")
        self._count, self._taken, self._lengths = shared[:1], shared[1:2], shared[2:]

    @property
    def full(self) -> bool:
        """Whether the next message would overwrite one that is not taken."""
        return self._count[0] - self._taken[0] >= _MESSAGES

    def put(self, component: str, message: LogMessage) -> bool:
        """Add a message, in the place of the oldest; whether it is time to take some."""
        status, category, text = message
        line = f"{component:.100}\0{status}\0{category:.100}\0{text}".encode("utf-8", "replace")
        line, number = line[:_MESSAGE_BYTES], self._count[0]
        place = number % _MESSAGES
        start = place * _MESSAGE_BYTES
        self._memory[start : start + len(line)] = line
        self._lengths[place] = len(line)
        self._count[0] = number + 1
        return place % (_MESSAGES // 4) == 0

    def take(self) -> Iterator[tuple[str, LogMessage]]:
        """Components and messages that have come since."""
        while self._taken[0] < (there := self._count[0]):
            for number in range(self._taken[0], there):
                yield self._at(number)
                self._taken[0] = number + 1

    def last(self) -> list[str]:
        """The last ones, oldest first, as phrases for a sentence."""
        count = self._count[0]
        found = map(self._at, range(max(0, count - _LOG_LINES), count))
        return [f"{name}: {shorten(message.text, 300)}" for name, message in found]

    def _at(self, number: int) -> tuple[str, LogMessage]:
        place = number % _MESSAGES
        start = place * _MESSAGE_BYTES
        line = self._memory[start : start + self._lengths[place]].decode("utf-8", "replace")
        component, status, category, text = line.split("\0", 3)
        return component, LogMessage(int(status), category, text)


class Marker:
    """The shared page. Made before the worker is; both sides use the same object. `clock` is the
    loop's, in `time` long steps tell how far they are (s, shape (1,)) and in `function` in
    which call of an FMU (see `participants.context.mark`), and `stop` (shape (1,)) is
    1 where the supervisor wants the run to end."""

    def __init__(self) -> None:
        page: Any = np.frombuffer(mmap.mmap(-1, _PAGE.itemsize), dtype=_PAGE)  # shared with forks
        self.clock: NDArray[np.int64] = page["clock"][0]
        self.time: NDArray[np.float64] = page["time"]
        self.stop: NDArray[np.int64] = page["stop"]
        self.function: NDArray[np.int64] = page["function"]
        self.time[0], self._inside = np.nan, False
        self._sequence, self._place, self._chunk = page["sequence"], page["place"], page["chunk"]
        self._component, self._call = page["component"], page["call"]
        self.messages = MessageRing()

    # the worker's side

    def calling(self, component: str, call: str) -> None:
        """Note a call outside the loop; two empty strings: it is over."""
        if call:
            self._component[0], self._call[0] = component.encode(), call.encode()
        self._place[0] = CALLING if call else LOOPING if self._inside else WORKING
        self._sequence[0] += 1

    def looping(self, inside: bool) -> None:
        """Note that the loop runs, or does not."""
        self._inside = inside
        self._place[0] = LOOPING if inside else WORKING
        self._sequence[0] += 1

    def begin_chunk(self, number: int) -> None:
        """The rows of chunk `number` come now, and there are none of it yet."""
        self.clock[ROWS] = 0
        self._chunk[0] = number

    # the supervisor's side

    def rows(self, chunk: int) -> int:
        """How many rows of `chunk` are there; 0 where the worker is not at it."""
        count = int(self.clock[ROWS])
        return count if self._chunk[0] == chunk else 0

    def where(self) -> Where:
        """What the worker does now, or did last."""
        place, reached = int(self._place[0]), float(self.time[0])
        names = (self._component[0], self._call[0]) if place == CALLING else (b"", b"")
        component, call = (name.decode("utf-8", "replace") for name in names)
        cycle, now, operation = (int(self.clock[i]) for i in (CYCLE, INSTANT, OPERATION))
        time = reached if reached == reached else None
        function = int(self.function[0])
        sequence = int(self._sequence[0])
        return Where(place, sequence, component, call, cycle, now, operation, time, function)


class RowMemory:
    """Room for the rows of two chunks, one being written while the other is taken.

    `descriptor` is of memory made by `shared_file`; the worker gives it its size (`create`).
    """

    def __init__(self, descriptor: int, rows: int, columns: int, *, create: bool = False) -> None:
        size = 2 * rows * 8 * (1 + columns)
        if create:
            os.ftruncate(descriptor, max(size, 1))
        memory: Any = mmap.mmap(descriptor, max(size, 1))
        times = np.frombuffer(memory, dtype=np.float64, count=2 * rows)
        values = np.frombuffer(memory, dtype=np.float64, count=2 * rows * columns, offset=16 * rows)
        self._times: NDArray[np.float64] = times.reshape(2, rows)
        self._values: NDArray[np.float64] = values.reshape(2, rows, columns)

    def of(self, chunk: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The times (s) and the rows of a chunk, by its number."""
        return self._times[chunk % 2], self._values[chunk % 2]
