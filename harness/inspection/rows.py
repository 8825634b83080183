"""Judging the rows of a run: are they finite, and are they those of another run."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.inspection.finding import VerdictError, failed
from harness.inspection.problem import listed
from harness.inspection.subject import Array, Subject
from harness.results.comparison import first_difference


def not_finite(subject: Subject, first: Array, rows: Array) -> NDArray[np.bool_]:
    """Which columns hold infinity or NaN, from the `first` row, after initialisation, on.

    A local variable that was so from the beginning, as an infinite limit is, does not count.
    """
    local = np.zeros(len(subject.labels), dtype=np.bool_)
    internal = [v.causality == "local" for v in subject.watched for _ in range(v.size)]
    local[: len(internal)] = internal
    bad = np.any(~np.isfinite(np.vstack([first, rows])), axis=0)
    return np.asarray(bad & ~(local & ~np.isfinite(first)))


def require_finite(subject: Subject, first: Array, rows: Array, what: str = "", *lies: str) -> None:
    """End the check with the names of the variables that are not finite; `what` stands before."""
    bad = not_finite(subject, first, rows)
    if bad.any():
        names = dict.fromkeys(n for n, b in zip(subject.labels, bad, strict=True) if b)
        raise VerdictError(failed(f"{what}values are not finite: {listed(list(names))}", *lies))


def require_same(
    subject: Subject, expected: Array, found: Array, otherwise: str, *lies: str, **data: str
) -> None:
    """End the check with the first difference of two runs, which `otherwise` introduces."""
    what = first_difference(subject.labels, expected, found)
    if what:
        raise VerdictError(failed(f"{otherwise}: {what}", *lies, **data))
