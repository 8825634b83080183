"""The final window in seconds, and a response that has settled only after a dwell in the band."""

import numpy as np
import pytest

from harness.results.step_response import segment_metrics

TIME = np.linspace(0.0, 10.0, 1001)
ONE = np.ones_like(TIME)


def response(enters: float) -> np.ndarray:
    """0.5 until it enters the band of 2 % for good."""
    return np.where(enters > TIME, 0.5, 1.0)


def test_settled_is_what_has_stayed_long_enough() -> None:
    for dwell, settled in ((0.0, True), (0.9, True), (1.1, False)):
        (found,) = segment_metrics(TIME, ONE, response(9.0), ONE, dwell=dwell)
        assert (found.settling_time is not None) is settled


@pytest.mark.parametrize(("window_time", "share"), [(4.0, 0.75), (2.0, 0.5), (20.0, 0.9)])
def test_a_window_of_seconds(window_time: float, share: float) -> None:
    """Half off until 9 s: of the last 4 s three quarters of the samples are off, of all 0.9."""
    (found,) = segment_metrics(TIME, ONE, response(9.0), ONE, window_time=window_time)
    assert found.tracking.steady_state_mean == pytest.approx(50.0 * share, abs=0.2)
