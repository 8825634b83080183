"""Set functions of FMUs and blocks read values where they come from, not where they were copied to
a moment before: what has been computed is passed on without waiting for the copy.

The copies stay, since rows, checkpoints and later readers look there.
"""

from __future__ import annotations

from collections.abc import Container

import numpy as np
from numpy.typing import NDArray

from harness.compiler import operations as op
from harness.participants.memory import Memory

_READS = {op.SET_FMI2: (5, 4), op.SET_FMI3: (5, 6), op.BLOCK: (5, 8)}
"""Operations that leave what they read as it is: the columns of its address and of its length."""
_CHANGES = (op.GET_FMI2, op.GET_FMI3, op.BLOCK)
_CHANGED = [6, 2]
"""Operations that change no slots but those of which they tell address and length, in these
columns; length 0 where they do not tell."""
_LEAVE_SLOTS = (op.CHECK, op.RECORD, op.SET_FMI2, op.SET_FMI3, op.STEP_FMI2, op.STEP_FMI3)


def shorten(memory: Memory, rows: NDArray[np.int64], copies: NDArray[np.int64]) -> None:
    """Change the addresses in `rows`, which are performed one after the other."""
    if np.isin(rows[:, 0], op.LEAPING).any():
        return
    same: dict[int, int] = {}  # by slot another one from which it has been copied

    def forget(changed: Container[int]) -> dict[int, int]:
        return {t: s for t, s in same.items() if t not in changed and s not in changed}

    for row in rows:
        code = int(row[0])
        if code in _READS:
            place, length = _READS[code]
            read = _slots(memory, row[place], row[length])
            found = [same.get(slot, -1) for slot in read]
            if found and found[0] >= 0 and found == list(range(found[0], found[0] + len(found))):
                row[place] = memory.address(found[0])
        if code == op.COPY:
            table = copies[row[1] : row[1] + row[2]].tolist()
            made = {target: source for source, target, _ in table}
            same = forget(made) | {t: s for t, s in made.items() if s not in made}
        elif code in _CHANGES and row[2]:
            same = forget(_slots(memory, *row[_CHANGED]))
        elif code not in _LEAVE_SLOTS:
            same = {}


def _slots(memory: Memory, address: int, n: int) -> range:
    """The slots that lie there; none where no slot does."""
    first, rest = divmod(int(address) - memory.address(0), 8)
    return range(first, first + int(n)) if rest == 0 else range(0)
