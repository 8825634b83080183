"""Holm's correction and the p-values under it are those of an independent computation."""

import numpy as np
import pytest
from scipy import stats

from harness.results.intervals import Sample, holm_levels

P = (0.001, 0.04, 0.011, 0.03, 0.9)


def rejected_by_hand(p_values: tuple[float, ...], alpha: float) -> set[int]:
    """The text-book procedure: in order of size, until one is too large."""
    found: set[int] = set()
    for k, (p, i) in enumerate(sorted((p, i) for i, p in enumerate(p_values))):
        if p > alpha / (len(p_values) - k):
            break
        found.add(i)
    return found


@pytest.mark.parametrize("alpha", [0.01, 0.05, 0.06, 0.2])
def test_what_is_below_its_level_is_what_holm_rejects(alpha: float) -> None:
    levels = holm_levels(P, alpha)
    below = {i for i, (p, level) in enumerate(zip(P, levels, strict=True)) if p <= level}
    assert below == rejected_by_hand(P, alpha)


def test_a_part_of_a_family_is_held_to_no_weaker_levels() -> None:
    whole, part = holm_levels(P), holm_levels(P[1:3], family=5)
    assert all(a <= b for a, b in zip(part, whole[1:3], strict=True))
    assert min(part) == 0.05 / 5


def test_a_mean_has_the_p_value_of_the_t_test() -> None:
    values = np.random.default_rng(1).normal(1.0, 2.0, 12)
    sample = Sample(tuple(values))
    expected = stats.ttest_1samp(values, 0.3).pvalue
    assert 2.0 * sample.tail(0.3) == pytest.approx(expected, rel=1e-12)


def test_an_interval_ends_where_its_test_decides() -> None:
    """At the ends of the interval of confidence 1 − α the two-sided p-value is α."""
    share = Sample((1.0,) * 5 + (0.0,) * 15, is_share=True)
    mean = Sample((1.0, 2.0, 4.0, 4.5))
    for sample in (share, mean):
        ours = sample.estimate(0.9)
        for end in (ours.low, ours.high):
            assert 2.0 * sample.tail(end) == pytest.approx(0.1, rel=1e-9)


def test_values_without_noise_are_certain() -> None:
    for sample in (Sample((2.0,)), Sample((2.0, 2.0, 2.0))):
        assert (sample.tail(2.0), sample.tail(2.5)) == (1.0, 0.0)


def test_quartiles_are_those_of_the_values() -> None:
    sample = Sample((0.0, 1.0, 2.0, 3.0, None))
    assert sample.has_within_quartiles(1.5) and not sample.has_within_quartiles(2.3)
    assert not Sample((1.0,)).has_within_quartiles(1.0)
