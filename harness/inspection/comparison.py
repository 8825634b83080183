"""Rows of watched variables compared bit by bit, in words."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.inspection.subject import Array, Subject


def same(a: Array, b: Array) -> bool:
    """Whether two runs agree to the last bit."""
    return a.shape == b.shape and a.tobytes() == b.tobytes()


def difference(subject: Subject, expected: Array, found: Array) -> str:
    """The first difference of two runs that are not the same."""
    if expected.shape != found.shape:
        return f"{len(found)} steps until the FMU ends the run instead of {len(expected)}"
    unequal = expected.view(np.uint64) != found.view(np.uint64)
    row = int(np.argmax(unequal.any(axis=1)))
    column = int(np.argmax(unequal[row]))
    return (
        f"{subject.labels[column]} is {found[row, column]:.17g} instead of "
        f"{expected[row, column]:.17g} after step {row + 1}"
    )


def not_finite(subject: Subject, first: Array, rows: Array) -> NDArray[np.bool_]:
    """Which columns hold infinity or NaN, from the `first` row, after initialisation, on.

    A local variable that was so from the beginning, as an infinite limit is, does not count.
    """
    local = np.zeros(len(subject.labels), dtype=np.bool_)
    internal = [v.causality == "local" for v in subject.watched for _ in range(v.size)]
    local[: len(internal)] = internal
    bad = np.any(~np.isfinite(np.vstack([first, rows])), axis=0)
    return np.asarray(bad & ~(local & ~np.isfinite(first)))


def names(subject: Subject, chosen: NDArray[np.bool_]) -> str:
    """The names of the watched variables that are chosen, five at most."""
    found = list(dict.fromkeys(n for n, c in zip(subject.labels, chosen, strict=True) if c))
    return ", ".join(found[:5]) + (" …" if len(found) > 5 else "")
