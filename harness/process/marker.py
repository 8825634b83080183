"""Memory that worker and supervisor share: where the worker is, and the rows not yet taken.

The loop keeps its clock (cycle, instant, rows, operation) in it and writes its rows into it, so
the supervisor sees both without the loop doing anything for it, and has them after the worker's
death. Calls outside the loop write their name. The memory has no name in any file system; it is
gone with the last process that holds it.
"""

from __future__ import annotations

import mmap
import os
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compiler.operations import CYCLE, INSTANT, OPERATION, ROWS

CLOCK_SIZE = 8
_SEQUENCE, _PLACE, _CHUNK, _STOP, _LOGGED, _TIME = range(CLOCK_SIZE, CLOCK_SIZE + 6)
_TEXT, _TEXT_SIZE = 256, 768
_LOG, _LOG_LINES, _LOG_SIZE = 1024, 3, 512
_SIZE = 4096

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


def shared_file(size: int) -> int:
    """A descriptor of `size` bytes of memory without a name."""
    descriptor = os.memfd_create("fmu-harness", os.MFD_CLOEXEC)
    os.ftruncate(descriptor, size)
    return descriptor


class Marker:
    """The shared page. Made before the worker is; both sides use the same object."""

    def __init__(self) -> None:
        self._memory = mmap.mmap(-1, _SIZE)  # shared with forked children
        self._numbers: NDArray[np.int64] = np.frombuffer(self._memory, dtype=np.int64)[:16]
        self.clock: NDArray[np.int64] = self._numbers[:CLOCK_SIZE]
        self._cells = memoryview(self._memory).cast("q")  # the same numbers, quicker one by one
        self.time: NDArray[np.float64] = self._numbers[_TIME : _TIME + 1].view(np.float64)
        self.time[0] = np.nan
        self.stop: NDArray[np.int64] = self._numbers[_STOP : _STOP + 1]

    # the worker's side

    def calling(self, component: str, call: str) -> None:
        """Note a call outside the loop; two empty strings: it is over."""
        if call:
            text = f"{component}\0{call}\0".encode()[: _TEXT_SIZE - 1] + b"\0"
            self._memory[_TEXT : _TEXT + len(text)] = text
        self._cells[_PLACE] = CALLING if call else WORKING
        self._cells[_SEQUENCE] += 1

    def reached(self, time: float) -> None:
        """Note the time (s) that a simulation outside the loop has reached."""
        self.time[0] = time

    def looping(self, inside: bool) -> None:
        """Note that the loop runs, or does not."""
        self._numbers[_PLACE] = LOOPING if inside else WORKING
        self._numbers[_SEQUENCE] += 1

    def logged(self, text: str) -> None:
        """Keep a line that an FMU logged."""
        line = text.encode()[: _LOG_SIZE - 1] + b"\0"
        start = _LOG + int(self._numbers[_LOGGED] % _LOG_LINES) * _LOG_SIZE
        self._memory[start : start + len(line)] = line
        self._numbers[_LOGGED] += 1

    def begin_chunk(self, number: int) -> None:
        """The rows of chunk `number` come now, and there are none of it yet."""
        self.clock[ROWS] = 0
        self._numbers[_CHUNK] = number

    @property
    def stop_asked(self) -> bool:
        """Whether the supervisor wants the run to end."""
        return bool(self._cells[_STOP])

    # the supervisor's side

    def ask_to_stop(self) -> None:
        """Let the worker end between two chunks."""
        self._numbers[_STOP] = 1

    def rows(self, chunk: int) -> int:
        """How many rows of `chunk` are there; 0 where the worker is not at it."""
        count = int(self.clock[ROWS])
        return count if int(self._numbers[_CHUNK]) == chunk else 0

    def where(self) -> Where:
        """What the worker does now, or did last."""
        text = bytes(self._memory[_TEXT : _TEXT + _TEXT_SIZE]).decode("utf-8", "replace")
        component, _, rest = text.partition("\0")
        place = int(self._numbers[_PLACE])
        outside = place == CALLING
        reached = float(self.time[0])
        return Where(
            place,
            int(self._numbers[_SEQUENCE]),
            component if outside else "",
            rest.partition("\0")[0] if outside else "",
            int(self.clock[CYCLE]),
            int(self.clock[INSTANT]),
            int(self.clock[OPERATION]),
            reached if reached == reached else None,
        )

    def log_lines(self) -> list[str]:
        """The last lines that FMUs logged, oldest first."""
        count = int(self._numbers[_LOGGED])
        places = [i % _LOG_LINES for i in range(max(0, count - _LOG_LINES), count)]
        starts = [_LOG + place * _LOG_SIZE for place in places]
        raw = [bytes(self._memory[start : start + _LOG_SIZE]) for start in starts]
        return [line.partition(b"\0")[0].decode("utf-8", "replace") for line in raw]


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
        self.times: NDArray[np.float64] = times.reshape(2, rows)
        self.values: NDArray[np.float64] = values.reshape(2, rows, columns)
