"""The compiled loop, and which instants of a program run as straight code.

Straight code of an instant does what `by_table` does with its rows, to the bit, and saves the look
at each row. It costs a twentieth of a second to make and milliseconds to load, so it is for
instants that come often enough; what all runs of a process have done counts together.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba import types
from numpy.typing import NDArray

from harness.compiler import operations as op
from harness.compiler.machine_code import settings, stamp
from harness.compiler.specialise import (
    HOST,
    Operation,
    Specialiser,
    prepared,
    read,
    size,
    write,
)
from harness.master.program.loop import perform, run_cycles

WORTH_MAKING, WORTH_LOADING = 20_000_000, 1_000_000
"""Rows to perform, each of which saves about 2 ns."""
_LARGEST = 500  # operations that are spelt out

_performed: Counter[tuple[Operation, ...]] = Counter()


@cache
def loop() -> Callable[[int], int]:
    """`run_cycles`, compiled or fetched; what its operations mean is kept for straight code.

    No vectors: they would cost the calls around them more than they save.
    """
    made: Any = run_cycles
    part: Any = perform
    with settings(LOOP_VECTORIZE=0, SLP_VECTORIZE=0):
        made.compile((types.int64,))
    for result in part.overloads.values():  # it was compiled just now
        text = prepared(result.library.get_llvm_str(), result.fndesc.llvm_func_name)
        write(_meaning_file(), text.encode())
    return made  # type: ignore[no-any-return]


def lay_out(program: NDArray[np.int64], instants: NDArray[np.int64], cycles: int) -> None:
    """Give straight code to those `instants` whose rows of `program` are performed often enough,
    where all are run for so many cycles."""
    rows = instants[:, 2] - instants[:, 1]
    if cycles * int(rows.sum()) < WORTH_LOADING or (specialiser := _specialiser()) is None:
        return
    for first, times in enumerate(np.bincount(instants[rows > 0, 1]).tolist()):
        if times:
            same = (instants[:, 1] == first) & (rows > 0)
            operations = _operations(program[first : instants[same, 2][0]])
            _performed[operations] += times * cycles * len(operations)
            performed = _performed[operations]
            if performed >= WORTH_LOADING and size(operations) <= _LARGEST:
                make = performed >= WORTH_MAKING
                instants[same, 3] = specialiser.address(operations, make)


def _operations(rows: NDArray[np.int64]) -> tuple[Operation, ...]:
    """What straight code of these rows depends on."""
    fixed, leaping = (*op.COUNTED, *op.LEAPING), op.LEAPING
    columns = rows[:, [0, 2]].tolist()
    return tuple(Operation(c, n if c in fixed else None, c in leaping) for c, n in columns)


def _meaning_file() -> Path:
    cached: Any = run_cycles
    key = hashlib.sha256(f"{stamp()} {numba.__version__} {HOST}".encode()).hexdigest()[:32]
    return Path(cached._cache.cache_path) / f"operations_{key}.ll"


@cache
def _specialiser() -> Specialiser | None:
    """None where nobody could keep what operations mean."""
    loop()
    text = read(_meaning_file())
    return None if text is None else Specialiser(text.decode(), _meaning_file().parent)
