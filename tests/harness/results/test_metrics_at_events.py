"""At an event a time has two rows, and every figure is that of the exact piecewise trajectory."""

import numpy as np
import pytest

from harness.results import metrics
from harness.results.step_response import segment_metrics, segments

# y = 0 on [0, 1], 1.2 on [1, 2], 1 on [2, 3]; u = 2, 1, 0; r = 1; few rows, none between events
TIME = np.array([0.0, 1.0, 1.0, 2.0, 2.0, 2.9, 3.0])
RESPONSE = np.array([0.0, 0.0, 1.2, 1.2, 1.0, 1.0, 1.0])
CONTROL = np.array([2.0, 2.0, 1.0, 1.0, 0.0, 0.0, 0.0])
ONE = np.ones(7)


def test_integrals_and_times_are_those_of_the_trajectory() -> None:
    (m,) = segment_metrics(TIME, ONE, RESPONSE, CONTROL)
    assert (m.delay_time, m.rise_time, m.settling_time) == (1.0, 0.0, 2.0)
    assert m.overshoot == pytest.approx(20.0)
    t = m.tracking
    found = (t.iae, t.ise, t.itae, t.control_effort, t.control_rms, t.actuator_travel)
    exact = (1.0 + 0.2, 1.0 + 0.04, 0.5 + 0.2 * 1.5, 4.0 + 1.0, np.sqrt(5.0 / 3.0), 2.0)
    assert found == pytest.approx(exact, rel=1e-14)
    assert (t.steady_state_mean, t.steady_state_max, t.lost_loop) == (0.0, 0.0, False)


@pytest.mark.parametrize(("before", "after", "settled"), [(1.0, 1.5, None), (1.5, 1.0, 3.0)])
def test_what_holds_at_the_end_is_the_value_after_the_last_event(
    before: float, after: float, settled: float | None
) -> None:
    response = np.array([0.0, 1.0, 1.0, 1.0, 1.0, before, after])
    time = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 3.0])
    assert metrics.settling_time(time, response, 0.0, 1.0) == settled
    found = segment_metrics(time, ONE, response, ONE, window=0.05)[0].tracking  # the rows at 3 s
    assert found.steady_state_mean == 100.0 * (1.0 - after)
    assert found.steady_state_max == 50.0, "a peak before the event is one"
    assert found.lost_loop == (after == 1.5)


def test_rows_of_events_without_a_jump_change_nothing() -> None:
    time = np.linspace(0.0, 5.0, 200)
    twice = np.sort(np.append(time, time[::3]))
    plain, repeated = (
        segment_metrics(t, np.ones(len(t)), 1.0 - np.exp(-2.0 * t), np.exp(-t))[0].as_dict()
        for t in (time, twice)
    )
    assert repeated == pytest.approx(plain, rel=1e-12, abs=1e-300)


def test_the_reference_steps_at_an_event() -> None:
    # 0.5 is passed through at 1 s by the iteration of the event
    time = np.array([0.0, 0.4, 1.0, 1.0, 1.0, 1.5, 2.0])
    reference = np.array([1.0, 1.0, 1.0, 0.5, 3.0, 3.0, 3.0])
    response = np.array([0.0, 1.0, 1.0, 1.0, 1.0, 3.0, 3.0])
    assert segments(time, reference) == (slice(0, 3), slice(4, 7))
    first, second = segment_metrics(time, reference, response, ONE)
    assert (first.start, first.initial, first.final, first.settling_time) == (0.0, 0.0, 1.0, 0.392)
    assert (second.start, second.initial, second.final) == (1.0, 1.0, 3.0)
    assert second.delay_time == 0.25 and second.tracking.iae == 0.5
