"""What the loop works on, as Python sees it: the arrays of one call of it."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from harness.compiler import operations as op
from harness.master.program.straight import loop

Reals = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Frame:
    """The arrays of one call of the loop, all in C's order.

    program    (n_operations, WIDTH), in order of execution
    instants   (n_instants, INSTANT_WIDTH), in order of their offset in the cycle
    clock      (CLOCK_SIZE,): see `CYCLE` and its fellows; on a fault it names the operation
    v          (n_slots,): every signal of the system
    copies     (n_copies, 3): source and destination slot, conversion; scales (n_copies, 2):
               factor, offset
    samples    prepared samples of all signals; cursors (n_signals,): next of each
    exchange   uint8, where C integers are encoded and decoded
    recorded   (n_columns,): slots of a row; rows (n_rows, n_columns), times (n_rows,) in s
    start, stop, cycle_ns   in ticks; `ticks` of them are a second
    until      the number of the cycle to stop before
    """

    program: Integers
    instants: Integers
    clock: Integers
    v: Reals
    copies: Integers
    scales: Reals
    samples: Reals
    cursors: Integers
    exchange: NDArray[np.uint8]
    recorded: Integers
    rows: Reals
    times: Reals
    start: int
    stop: int
    cycle_ns: int
    ticks: int
    until: int

    def run(self) -> int:
        """Run the loop; an outcome of `operations`."""
        cells = self._cells()
        return loop()(cells.ctypes.data)

    def _cells(self) -> Integers:
        """The frame as the loop sees it."""
        cells = [0] * op.FRAME_SIZE
        for name, place in _PLACES:
            cells[place] = getattr(self, name).ctypes.data
        cells[op.N_INSTANTS], cells[op.N_ROWS] = len(self.instants), len(self.rows)
        cells[op.START], cells[op.STOP], cells[op.UNTIL] = self.start, self.stop, self.until
        cells[op.CYCLE_NS] = self.cycle_ns
        made = np.array(cells, dtype=np.int64)
        made.view(np.float64)[op.TICKS] = self.ticks
        return made


_PLACES = [
    (field.name, getattr(op, {"rows": "ROWS_AT"}.get(field.name, field.name.upper())))
    for field in fields(Frame)[:12]
]
"""The arrays, and the cells that hold their addresses."""
