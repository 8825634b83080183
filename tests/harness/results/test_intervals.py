"""Paired differences and shares: closed forms, and intervals that cover as often as they say."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from harness.errors import UsageError
from harness.results.intervals import paired_difference, share


def test_the_t_interval_is_that_of_the_paired_test() -> None:
    random = np.random.default_rng(3)
    a, b = random.normal(1.0, 2.0, 30), random.normal(0.0, 1.0, 30)
    d = paired_difference(a, b, confidence=0.9)
    reference = stats.ttest_rel(a, b).confidence_interval(0.9)
    assert (d.low, d.high) == pytest.approx((reference.low, reference.high), rel=1e-12)
    assert d.value == pytest.approx(np.mean(a) - np.mean(b))


def test_an_interval_covers_the_truth_as_often_as_it_says() -> None:
    random, hits, trials = np.random.default_rng(5), 0, 300
    for _ in range(trials):
        common = random.normal(0, 100, 40)
        d = paired_difference(common + random.normal(0.5, 1, 40), common)
        hits += d.low <= 0.5 <= d.high
        assert d.high - d.low < 2  # the common part, 100 times as large, is gone
    assert stats.binomtest(hits, trials, 0.94).pvalue > 1e-3


def test_pairs_without_a_number_are_left_out_and_counted() -> None:
    d = paired_difference([1.0, None, 3.0, float("nan"), 5.0], [0.0, 1.0, 1.0, 1.0, 2.0])
    assert (d.value, d.runs, d.missing) == (2.0, 5, 2)
    equal = paired_difference([1.0, 2.0], [1.0, 2.0])
    assert (equal.low, equal.high) == (0.0, 0.0)
    assert paired_difference([1.0, 2.1, 3.0], [0.0, 1.0, 2.0]).low > 0.0


@given(st.integers(1, 300), st.data())
def test_the_wilson_interval_solves_its_equation(n: int, data: st.DataObject) -> None:
    k = data.draw(st.integers(0, n))
    s = share([True] * k + [False] * (n - k))
    z = stats.norm.ppf(0.975)
    for bound, extreme in ((s.low, k == 0), (s.high, k == n)):
        assert 0.0 <= bound <= 1.0
        if not extreme:  # the score test is just significant at the bound
            assert abs(s.value - bound) == pytest.approx(z * np.sqrt(bound * (1 - bound) / n))
    assert s.low <= s.value <= s.high


def test_faults() -> None:
    with pytest.raises(UsageError, match="pairs were expected, got 1 values and 2"):
        paired_difference([1.0], [1.0, 2.0])
    with pytest.raises(UsageError, match="at least 2 pairs of numbers are needed, got 1 of 2"):
        paired_difference([1.0, None], [1.0, 2.0])
    with pytest.raises(UsageError, match="between 0 and 1, got 95"):
        share([True], confidence=95)
    with pytest.raises(UsageError, match="at least one run"):
        share([])
