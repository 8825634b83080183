"""Which watched variables became infinite or NaN."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.inspection.subject import Array, Subject


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
