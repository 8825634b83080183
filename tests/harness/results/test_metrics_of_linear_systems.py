"""Step metrics against the closed forms of first- and second-order responses."""

import math

import numpy as np
import pytest

from harness.results.step_response import segment_metrics

H = 1e-3


@pytest.mark.parametrize(("before", "after"), [(0.0, 2000.0), (3.0, -1.0), (-5.0, -2.0)])
def test_first_order_response(before: float, after: float) -> None:
    T, start = 0.5, 1.0
    t = np.arange(0, 12.0, H)
    r = np.where(t >= start, after, before)
    decay = np.exp(-np.maximum(t - start, 0.0) / T)
    y = after + (before - after) * decay
    (m,) = segment_metrics(t, r, y, r - y, band=0.02)
    size, span = after - before, t[-1] - start
    assert (m.start, m.initial, m.final, m.overshoot) == (start, before, after, 0.0)
    assert m.delay_time is not None
    assert m.rise_time is not None
    assert m.settling_time is not None
    interpolation = (H / T) ** 2 / 8 * T * 50  # chord of an exponential at 2 % of its height
    assert m.delay_time == pytest.approx(T * math.log(2), abs=interpolation)
    assert m.rise_time == pytest.approx(T * math.log(9), abs=interpolation)
    assert m.settling_time == pytest.approx(T * math.log(50), abs=interpolation)
    end = math.exp(-span / T)
    assert m.tracking.iae == pytest.approx(abs(size) * T * (1 - end), rel=(H / T) ** 2)
    assert m.tracking.ise == pytest.approx(size**2 * T / 2 * (1 - end**2), rel=(H / T) ** 2)
    itae = abs(size) * T * (T - (T + span) * end)
    assert m.tracking.itae == pytest.approx(itae, rel=(H / T) ** 2)
    # u = e is held here: a left sum, H/2·e0² above the integral to first order in H
    effort = size**2 * H * (1 - math.exp(-2 * span / T)) / (1 - math.exp(-2 * H / T))
    assert m.tracking.control_effort == pytest.approx(effort, rel=1e-9)
    assert m.tracking.control_rms == pytest.approx(math.sqrt(effort / span), rel=1e-9)
    assert m.tracking.actuator_travel == pytest.approx(abs(size) * (1 - end), rel=1e-9)
    assert m.tracking.lost_loop is False


@pytest.mark.parametrize("zeta", [0.2, 0.5, 0.7])
def test_second_order_response(zeta: float) -> None:
    wn = 3.0
    t = np.arange(0, 20.0, H)
    wd, phi = wn * math.sqrt(1 - zeta**2), math.acos(zeta)
    y = 1 - np.exp(-zeta * wn * t) / math.sqrt(1 - zeta**2) * np.sin(wd * t + phi)
    (m,) = segment_metrics(t, np.ones_like(t), y, np.zeros_like(t), band=0.05)
    peak = 100 * math.exp(-math.pi * zeta / math.sqrt(1 - zeta**2))
    assert m.overshoot == pytest.approx(peak, abs=100 * wn**2 * H**2 / 8)
    assert m.settling_time is not None
    inside = np.abs(y - 1) <= 0.05
    first = int(np.argmin(inside[::-1]))  # samples from the end back to the last one outside
    assert t[-1] - first * H == pytest.approx(m.settling_time, abs=H)
    assert np.all(np.abs(y[t >= m.settling_time] - 1) <= 0.05)
    iae_upper = np.sum(np.abs(1 - y)) * H
    assert m.tracking.iae == pytest.approx(iae_upper - H / 2, abs=1e-6)
    ise = (1 + 4 * zeta**2) / (4 * zeta * wn)  # ∫e² of the standard second-order loop
    assert m.tracking.ise == pytest.approx(ise, abs=1e-5)


def test_metrics_do_not_depend_on_units_of_the_response() -> None:
    t = np.arange(0, 5, 0.01)
    y = 1 - np.exp(-t) * np.cos(3 * t)
    (one,) = segment_metrics(t, np.ones_like(t), y, y)
    (kilo,) = segment_metrics(t, np.full_like(t, 1000.0), 1000 * y, y)
    assert kilo.tracking.iae == pytest.approx(1000 * one.tracking.iae)
    for name in ("delay_time", "rise_time", "overshoot", "settling_time"):
        assert getattr(kilo, name) == pytest.approx(getattr(one, name))
