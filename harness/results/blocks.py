"""Rows held in memory, in blocks each of which is twice as large as the one before: fresh memory is
much faster to write to in few large pieces than in many small ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
_FIRST, _MOST = 1024, 2**20  # rows of a block


class Blocks:
    """Times (n,) and rows (n, columns) that grow."""

    def __init__(self, columns: int) -> None:
        """Without rows."""
        self._blocks = [(np.empty(0), np.empty((0, columns)))]
        self._used = 0  # rows of the last block

    def append(self, times: Reals, rows: Reals) -> None:
        """Copies them."""
        while len(times):
            own_times, own_rows = self._blocks[-1]
            room = len(own_times) - self._used
            if room == 0:
                size = min(max(_FIRST, 2 * len(own_times)), _MOST)
                self._blocks.append((np.empty(size), np.empty((size, rows.shape[1]))))
                self._used = 0
                continue
            place = slice(self._used, self._used + len(times[:room]))
            own_times[place], own_rows[place] = times[:room], rows[:room]
            self._used = place.stop
            times, rows = times[room:], rows[room:]

    def all(self) -> tuple[Reals, Reals]:
        """Everything, in arrays of its size."""
        *full, (times, rows) = self._blocks
        whole = [*full, (times[: self._used], rows[: self._used])]
        return np.concatenate([t for t, _ in whole]), np.concatenate([r for _, r in whole])
