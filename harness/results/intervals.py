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


@dataclass(frozen=True)
class Sample:
    """What independent runs gave for one figure, None where a run has none: its mean, or where
    `is_share` the share of the runs in which something happened (1, else 0). A single value is no
    sample of anything, and is taken as it is."""

    values: tuple[float | None, ...]
    is_share: bool = False

    @property
    def numbers(self) -> Array:
        """The values that are finite, shape (n,)."""
        found = [value for value in self.values if value is not None and np.isfinite(value)]
        return np.array(found, dtype=np.float64)

    @property
    def is_random(self) -> bool:
        """Whether it has an interval."""
        return len(self.numbers) > 1

    @property
    def is_missing(self) -> bool:
        """Whether half of the runs or more have no value (a loop that never settles)."""
        return 2 * len(self.numbers) <= len(self.values)

    def estimate(self, confidence: float = 0.95) -> Estimate:
        """The figure with its interval: that of `paired_difference` or of `share`."""
        numbers, runs = self.numbers, len(self.values)
        if len(numbers) < 2:
            one = float(numbers[0]) if len(numbers) else np.nan
            runs = 0 if not len(numbers) and runs == 1 else runs
            return Estimate(one, one, one, runs, len(self.values) - len(numbers))
        if self.is_share:
            return share([bool(value) for value in numbers], confidence=confidence)
        return paired_difference(self.values, np.zeros(runs), confidence=confidence)

    def tail(self, limit: float) -> float:
        """The one-sided p-value against `limit`: how likely a figure at least as far from it, on
        the same side, is where the true one equals it. Student's t for a mean; for a share the
        normal approximation at the limit, whose intervals are Wilson's."""
        numbers = self.numbers
        away = abs(float(np.mean(numbers)) - limit) if len(numbers) else np.nan
        if away == 0.0:
            return 1.0
        if len(numbers) < 2:
            return 0.0
        if self.is_share:
            error = np.sqrt(max(limit * (1.0 - limit), 0.0) / len(numbers))
            return float(stats.norm.sf(away / error)) if error else 0.0
        error = stats.sem(numbers)
        return float(stats.t.sf(away / error, len(numbers) - 1)) if error else 0.0

    def has_within_quartiles(self, limit: float) -> bool:
        """Whether `limit` lies within the interquartile range of the values."""
        if not self.is_random:
            return False
        low, high = np.quantile(self.numbers, (0.25, 0.75))
        return bool(low < limit < high)


def holm_levels(
    p_values: Sequence[float], alpha: float = 0.05, *, family: int | None = None
) -> list[float]:
    """The level at which Holm's step-down procedure judges each of simultaneous tests, `family` of
    them in all where not every one is among the p-values.

    The smallest of m p-values is held against α/m, the next against α/(m − 1), and so on; from the
    first that misses its level on, all are judged at that level, which they miss too. The
    probability of any false decision among them is at most α, however they depend on each other.
    """
    m = max(family or 0, len(p_values))
    levels, stopped = [0.0] * len(p_values), 0.0
    for k, i in enumerate(sorted(range(len(p_values)), key=p_values.__getitem__)):
        levels[i] = stopped or alpha / (m - k)
        if p_values[i] > levels[i]:
            stopped = levels[i]
    return levels


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
