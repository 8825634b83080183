"""Comparing variants over many seeds: paired differences of means, and shares, with intervals.

Pairing: value i of both variants comes from the same seed, so that both met the same noise; the
interval is that of the differences, which is narrower than that of two separate samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from harness.errors import UsageError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Estimate:
    """A figure of `runs` with its interval [`low`, `high`]: a mean, a share, or the one value.

    `missing` counts the runs without a number (such as "never settled"); read the figure with
    them in mind.
    """

    value: float
    low: float
    high: float
    runs: int
    missing: int = 0

    def __str__(self) -> str:
        if self.runs == 0:
            return "–"
        text = f"{self.value:.3g}"
        if self.low != self.high:
            text += f" [{self.low:.3g}, {self.high:.3g}]"
        return text + (f" ({self.missing} of {self.runs} without)" if self.missing else "")


def paired_difference(
    first: Sequence[float | None] | Array,
    second: Sequence[float | None] | Array,
    *,
    confidence: float = 0.95,
) -> Estimate:
    """The mean difference first − second of paired values, in their unit: mean ± t_{n−1}·s/√n,
    exact for normal differences, good for many pairs.

    Values that are None, NaN or infinite leave their pair out.
    """
    if len(first) != len(second):
        raise UsageError(f"pairs were expected, got {len(first)} values and {len(second)}")
    _check_confidence(confidence)
    a, b = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    finite = np.isfinite(a) & np.isfinite(b)
    d = a[finite] - b[finite]
    if len(d) < 2:
        raise UsageError(f"at least 2 pairs of numbers are needed, got {len(d)} of {len(a)}")
    mean, error = float(np.mean(d)), float(stats.sem(d))
    half = float(stats.t.ppf(0.5 + 0.5 * confidence, len(d) - 1)) * error
    return Estimate(mean, mean - half, mean + half, len(a), len(a) - len(d))


def share(happened: Sequence[bool], *, confidence: float = 0.95) -> Estimate:
    """The share of runs in which something happened.

    The Wilson interval, with z the normal quantile and p = count/n:
    (p + z²/2n ± z·√(p(1 − p)/n + z²/4n²)) / (1 + z²/n); it stays within [0, 1] and is honest
    for 0 of n too.
    """
    _check_confidence(confidence)
    if len(happened) == 0:
        raise UsageError("a share needs at least one run, got none")
    count, runs = int(np.count_nonzero(happened)), len(happened)
    interval = stats.binomtest(count, runs).proportion_ci(confidence, method="wilson")
    return Estimate(count / runs, float(interval.low), float(interval.high), runs)


def _check_confidence(confidence: float) -> None:
    if not 0.0 < confidence < 1.0:
        raise UsageError(f"the confidence must lie between 0 and 1, got {confidence!r}")
