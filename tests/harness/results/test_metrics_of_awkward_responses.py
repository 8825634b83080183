"""Metrics where a textbook response ends: never settled, lost, noisy, several steps, moving."""

import numpy as np
import pytest

from harness.errors import UsageError
from harness.results.metrics import final_window, first_crossing, lost_loop, settling_time
from harness.results.step_response import (
    metric_units,
    segment_metrics,
    tracking_metrics,
)

T = np.arange(0.0, 10.0, 0.01)
ONE = np.ones_like(T)


def test_what_never_happens_is_none() -> None:
    (low,) = segment_metrics(T, ONE, 0.4 * (1 - np.exp(-T)), ONE)
    assert (low.delay_time, low.rise_time, low.settling_time) == (None, None, None)
    (ripple,) = segment_metrics(T, ONE, 1 - np.exp(-5 * T) + 0.1 * np.sin(20 * T) * (T > 1), ONE)
    assert ripple.delay_time is not None
    assert ripple.settling_time is None


def test_one_outlier_unsettles_and_the_last_sample_decides() -> None:
    y = ONE.copy()
    assert settling_time(T, y, 0.0, 1.0) == 0.0
    y[500] = 1.5
    assert settling_time(T, y, 0.0, 1.0) == pytest.approx(5.0 + 0.01 * (0.48 / 0.5))
    y[-1] = 1.5
    assert settling_time(T, y, 0.0, 1.0) is None


def test_a_crossing_lies_on_the_line_between_two_samples() -> None:
    t, y = np.array([0.0, 1.0, 3.0, 4.0]), np.array([0.0, 1.0, 5.0, 0.0])
    assert first_crossing(t, y, 2.0, rising=True) == 1.5
    assert first_crossing(t, -y, -2.0, rising=False) == 1.5
    assert first_crossing(t, y, 0.0, rising=True) == 0.0
    assert first_crossing(t, y, 6.0, rising=True) is None


def test_steady_state_error_is_in_percent_of_the_reference_over_the_window() -> None:
    r = np.full_like(T, -200.0)
    error = np.where(np.arange(len(T)) % 2 == 0, 6.0, -2.0)  # mean 2, rms √20, max 6
    wrong_before = np.where(T < 8.9, 1e3, 0.0)
    m = tracking_metrics(T, r, r - error - wrong_before, ONE, window=0.1)
    assert m.steady_state_mean == pytest.approx(1.0)
    assert m.steady_state_rms == pytest.approx(np.sqrt(20) / 2)
    assert m.steady_state_max == pytest.approx(3.0)


def test_the_final_window_is_a_share_of_the_span_wherever_it_begins() -> None:
    for begin in (0.0, 5.0, -100.0):
        t = begin + np.arange(101.0)
        assert final_window(t, 0.2) == slice(80, None)
        assert final_window(t, 1.0) == slice(0, None)
        assert final_window(t, 1e-9) == slice(100, None)


@pytest.mark.parametrize(
    ("response", "lost"),
    [
        (ONE, False),
        (0.81 * ONE, False),
        (0.79 * ONE, True),
        (np.where(T > 9.985, 3.0, 1.0), False),  # one wild last sample
        (np.where(T > 9.5, 3.0, 1.0), True),
        (np.where(T < 1.0, 12.0, 1.0), True),  # diverged, and came back
        (np.where(T < 1.0, np.nan, 1.0), True),
        (np.where(T < 1.0, np.inf, 1.0), True),
    ],
)
def test_lost_loop(response: np.ndarray, lost: bool) -> None:
    for scale in (1.0, -2000.0):  # of the reference: the limits are relative
        assert lost_loop(T, scale * ONE, scale * response, window=0.5) is lost


def test_each_step_of_a_multi_step_reference_is_measured_by_itself() -> None:
    edges, levels, tau = [1.0, 4.0, 7.0], [2.0, -1.0, 3.0], 0.1
    r, y = np.zeros_like(T), np.zeros_like(T)
    for edge, level, before in zip(edges, levels, [0.0, *levels], strict=False):
        after = edge <= T
        r[after] = level
        y[after] = level + (before - level) * np.exp(-(T[after] - edge) / tau)
    found = segment_metrics(T, r, y, r)
    assert [(m.start, m.initial, m.final) for m in found] == [(1, 0, 2), (4, 2, -1), (7, -1, 3)]
    for m in found:
        assert m.delay_time == pytest.approx(tau * np.log(2), abs=2e-4)
        assert m.tracking.iae == pytest.approx(abs(m.final - m.initial) * tau, rel=1e-3)


def test_what_is_no_step_or_no_array_is_refused() -> None:
    with pytest.raises(UsageError, match=r"for 1 samples.*use tracking_metrics"):
        segment_metrics(T, np.sin(T), T, T)
    with pytest.raises(UsageError, match=r"control has shape \(3,\)"):
        tracking_metrics(T, ONE, ONE, np.ones(3))
    with pytest.raises(UsageError, match="at times that do not decrease"):
        tracking_metrics(ONE, ONE, ONE, ONE)
    with pytest.raises(UsageError, match=r"share of the time in \(0, 1\], got 0"):
        tracking_metrics(T, ONE, ONE, ONE, window=0)


def test_every_figure_has_a_unit() -> None:
    (m,) = segment_metrics(T, ONE, 1 - np.exp(-T), ONE)
    assert list(m.as_dict()) == list(metric_units("N", "1"))
