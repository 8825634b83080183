"""The host of a run: memory for its clock and its rows, and who is asked between chunks.

A run in the caller's process has memory of its own and nobody to ask (`Host`). A
supervised one has shared memory, takes checkpoints, and may begin in the middle.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from harness.compiler import operations as op
from harness.participants.fmu import Told

if TYPE_CHECKING:
    from harness.master.program.link import Program

_CHUNK_BYTES = 2**21  # the cache that a core has for itself
_FEWEST, _MOST = 1024, 65536  # rows

Times = NDArray[np.float64]
Rows = NDArray[np.float64]


class Host:
    """A run alone in its process; `clock` is the loop's, see `operations.CYCLE` and its fellows;
    `told` is where long steps tell their time (s), look whether to end, and tell their call."""

    def __init__(self) -> None:
        self.clock: NDArray[np.int64] = np.zeros(op.CLOCK_SIZE, dtype=np.int64)
        self.told = Told()
        self._times: Times = np.empty(0)
        self._rows: Rows = np.empty((0, 0))

    def chunk_rows(self, columns: int) -> int:
        """How many rows a chunk may have, where a cycle has no more."""
        return max(_FEWEST, min(_MOST, _CHUNK_BYTES // (8 * (1 + columns))))

    def room(self, rows: int, columns: int) -> tuple[Times, Rows]:
        """Memory for the next chunk: times (s) and rows, at least `rows` of them.

        The rows of the chunk before it have been handed to the recorder.
        """
        if len(self._times) < rows:  # memory fresh from the system is slow to touch
            self._times = np.empty(rows)
            self._rows = np.empty((rows, columns))
        return self._times, self._rows

    def most_rows(self, rows: int, columns: int) -> None:
        """No chunk will have more than that; said once, before the first."""

    def linked(self, program: Program) -> None:
        """The program is there, nothing of it has run."""

    def begin(self, program: Program) -> int:
        """Everything is initialised: the cycle to begin with, after bringing the system there."""
        return 0

    def cycles_until(self, cycle: int) -> int:
        """How many cycles from `cycle` on a chunk may have at most."""
        return 2**62

    def loop(self, inside: bool) -> None:
        """The compiled loop is entered or left."""

    def between(self, cycle: int) -> None:
        """A chunk is done and recorded, `cycle` is next; may raise to end the run."""


usual: Callable[[], Host] = Host
"""What a run stands in that is given nothing else."""
