"""Set functions of FMUs read values where they come from, not where they have been copied to a
moment before: what one FMU or block has computed is then passed on without waiting for the copy.

The copies stay, since rows, checkpoints and later readers look there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.compiler import operations as op
from harness.participants.memory import Memory

_LEAVE_SLOTS = (op.CHECK, op.RECORD, op.SET_FMI2, op.SET_FMI3, op.STEP_FMI2, op.STEP_FMI3)
"""Operations that change no slot."""
_VALUES = 5  # the column of a set function with the address of the values


def shorten(memory: Memory, rows: NDArray[np.int64], copies: NDArray[np.int64]) -> None:
    """Change the set functions in `rows`, which are performed one after the other."""
    codes: Sequence[int] = rows[:, 0].tolist()
    if any(code in op.LEAPING for code in codes):
        return
    sources: dict[int, int] = {}  # of slots that hold the same as another one
    for row, code in zip(rows, codes, strict=True):
        if code == op.COPY:
            made = {
                target: source for source, target, _ in copies[row[1] : row[1] + row[2]].tolist()
            }
            pairs = [*(pair for pair in sources.items() if pair[0] not in made), *made.items()]
            sources = {target: source for target, source in pairs if source not in made}
        elif code in (op.SET_FMI2, op.SET_FMI3):
            first, offset = divmod(int(row[_VALUES]) - memory.address(0), 8)
            n = int(row[6] if code == op.SET_FMI3 else row[4])
            found = [sources.get(slot, -1) for slot in range(first, first + n)]
            if offset == 0 and found[0] >= 0 and found == list(range(found[0], found[0] + n)):
                row[_VALUES] = memory.address(found[0])
        elif code not in _LEAVE_SLOTS:
            sources.clear()
