"""Gains of the stated rules against closed forms and against the loops they promise."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from controllers.core.errors import ControllerError
from controllers.pid.design import (
    simc_first_order,
    simc_integrating,
    ultimate_point,
    ziegler_nichols,
)


def test_ziegler_nichols_table() -> None:
    pid, pi, p = (ziegler_nichols(10.0, 2.0, kind) for kind in ("PID", "PI", "P"))
    assert (pid.kp, pid.ki, pid.kd) == pytest.approx((6.0, 6.0, 1.5))
    assert (pi.kp, pi.ki, pi.kd) == pytest.approx((4.5, 2.7, 0.0))
    assert (p.kp, p.ki, p.kd) == (5.0, 0.0, 0.0)


def test_simc_of_an_integrating_process_has_the_published_margins() -> None:
    # Tight SIMC on k'·exp(−θs)/s: gain margin 2.96, phase margin 46.9°, M_s 1.70 (Skogestad 2003).
    k, theta = 104_000.0, 0.015
    gains = simc_integrating(k, theta)
    w = np.logspace(-1, 4, 200_001)
    loop = (gains.kp + gains.ki / (1j * w)) * k * np.exp(-1j * w * theta) / (1j * w)
    phase = np.unwrap(np.angle(loop))
    crossing = np.argmin(np.abs(np.abs(loop) - 1.0))
    ultimate = np.argmax((phase < -math.pi) & (w > w[crossing]))
    assert 180 + math.degrees(phase[crossing]) == pytest.approx(46.9, abs=0.1)
    assert 1 / abs(loop[ultimate]) == pytest.approx(2.96, abs=0.01)
    assert np.max(1 / np.abs(1 + loop)) == pytest.approx(1.70, abs=0.005)


def test_simc_with_a_second_lag_cancels_it() -> None:
    gains = simc_integrating(2.0, 0.1, lag=0.3)
    kc, ti = 1 / (2.0 * 0.2), 0.8
    # K_c·(T_i·s + 1)·(τ_2·s + 1)/(T_i·s) in parallel form
    assert gains.kp == pytest.approx(kc * (ti + 0.3) / ti)
    assert gains.ki == pytest.approx(kc / ti)
    assert gains.kd == pytest.approx(kc * 0.3)


def test_simc_of_a_first_order_process() -> None:
    slow, fast = simc_first_order(2.0, 10.0, 0.1), simc_first_order(2.0, 0.3, 0.1)
    assert slow.kp / slow.ki == pytest.approx(0.8)  # T_i = 4·(τ_c + θ)
    assert fast.kp / fast.ki == pytest.approx(0.3)  # T_i = τ_1


def test_ultimate_point_of_a_sampled_double_pole() -> None:
    # x⁺ = x + v, v⁺ = u: z² − z + K, on the unit circle for K = 1 at 60°, so 6 samples.
    A, b, c = np.array([[1.0, 1.0], [0.0, 0.0]]), np.array([0.0, 1.0]), np.array([1.0, 0.0])
    point = ultimate_point(A, b, c, 0.01)
    assert point.gain == pytest.approx(1.0, rel=1e-9)
    assert point.period == pytest.approx(0.06, rel=1e-6)


def test_ultimate_point_of_a_lagged_integrator_is_where_the_loop_rings() -> None:
    T, g, tau = 0.01, 104_000.0, 0.01
    M = expm(np.array([[0, g, 0], [0, -1 / tau, 1 / tau], [0, 0, 0]]) * T)
    A, b, c = M[:2, :2], M[:2, 2], np.array([1.0, 0.0])
    point = ultimate_point(A, b, c, T)
    for factor, growing in ((0.99, False), (1.01, True)):
        poles = np.linalg.eigvals(A - factor * point.gain * np.outer(b, c))
        assert (np.max(np.abs(poles)) > 1.0) == growing


def test_faults_are_named() -> None:
    with pytest.raises(ControllerError, match="stable for small gains"):
        ultimate_point(np.array([[2.0]]), np.array([-1.0]), np.array([1.0]), 0.1)
    with pytest.raises(ControllerError, match="kind: expected one of 'P', 'PI', 'PID'"):
        ziegler_nichols(1.0, 1.0, "PD")
