"""The sampled filter: first order to (11) and (16), sound for every step, exact where linear."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from controllers.core.errors import ControllerError
from controllers.papers.takata.kalman_bucy import KalmanBucy
from controllers.papers.takata.machine_model import MachineParameters, drift_jacobian, machine_rate
from tests.controllers.compiled import assert_bit_equal, run

S_0 = np.array([[5.0, 10.0], [10.0, 50.0]])
P = MachineParameters().model().parameters
H = np.array([0.0, 1.0])


def printed(**changes):
    return KalmanBucy(
        **{
            "model": "controllers.papers.takata.machine_model:MachineParameters",
            "measured": ("speed",),
            "noise_intensity": (1.0,), "start": (0.0, 0.0),
            "covariance": tuple(map(tuple, S_0)), **changes,
        }
    )  # fmt: skip


def measured(t):
    return 1.5 * math.sin(3.0 * t) + 0.3


def control(t):
    return 0.2 * math.cos(2.0 * t)


def kernel(function, x, u, size):
    out = np.empty(size)
    function(P, x, np.array([u]), out)
    return out


def continuous(stop):
    """(11), (15), (16) by DOP853 with rtol 1e-11."""

    def slope(t, z):
        x, S = z[:2], z[2:].reshape(2, 2)
        F = kernel(drift_jacobian, x, control(t), 4).reshape(2, 2)
        K = S @ H
        rate = kernel(machine_rate, x, control(t), 2) + K * (measured(t) - x[1])
        return [*rate, *(F @ S + S @ F.T - np.outer(K, K)).ravel()]

    z = np.concatenate([np.zeros(2), S_0.ravel()])
    return solve_ivp(slope, (0.0, stop), z, method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]


def sampled(T, stop):
    """Estimate and deviations after the update at `stop`; u(t − T) is that of the middle before."""
    times = T * np.arange(round(stop / T) + 1)
    u = [(control(t - T / 2), measured(t)) for t in times]
    return run(printed().block(T), np.array(u))[-1, :4]


def test_error_is_of_first_order():
    """Halving T halves the error, and what extrapolation leaves of it is of second order."""
    z = continuous(0.6)
    exact = np.array([z[0], z[1], math.sqrt(z[2]), math.sqrt(z[5])])
    errors = [sampled(T, 0.6) - exact for T in (0.003, 0.0015, 0.00075)]
    for coarse, fine in pairwise(errors):
        assert np.all(np.abs(coarse / fine - 2.0) < 0.02)
    extrapolated = [np.abs(2.0 * fine - coarse).max() for coarse, fine in pairwise(errors)]
    assert extrapolated[1] < 3e-5
    assert 3.0 < extrapolated[0] / extrapolated[1] < 5.0


@pytest.mark.parametrize("T", [0.01, 0.02, 0.1, 0.5])
def test_covariance_stays_definite_where_explicit_euler_does_not(T):
    rows = run(printed(substeps=10).block(T), np.zeros((200, 2)))
    gains = rows[:, 7:9]
    assert np.isfinite(rows).all()
    assert np.all(rows[:, 2:4] >= 0.0)
    assert np.all(gains[:, 1] <= 1.0)
    F = kernel(drift_jacobian, np.zeros(2), 0.0, 4).reshape(2, 2)
    S = S_0 + T * (F @ S_0 + S_0 @ F.T - np.outer(S_0 @ H, S_0 @ H))
    assert (np.linalg.eigvalsh(S)[0] < 0.0) == (T >= 0.02)


def test_linear_filter_is_the_kalman_filter_of_the_sampled_model():
    T, rng = 0.02, np.random.default_rng(2)
    A = kernel(drift_jacobian, np.zeros(2), 0.0, 4).reshape(2, 2)
    u = rng.normal(size=(300, 2))
    rows = run(printed(linear=True, substeps=40, process_noise=(0.0,)).block(T), u)
    whole = expm(T * np.vstack([np.column_stack([A, [0.0, -0.8 / 0.06]]), np.zeros(3)]))
    x, S = np.zeros(2), S_0.copy()
    for k, (held, y) in enumerate(u):
        if k:
            x, S = whole[:2, :2] @ x + whole[:2, 2] * held, whole[:2, :2] @ S @ whole[:2, :2].T
        K = S @ H / (S[1, 1] + 1.0 / T)
        x, S = x + K * (y - x[1]), S - np.outer(K, S[1])
        assert rows[k, :2] == pytest.approx(x, rel=1e-8, abs=1e-8)
        assert rows[k, 2:4] == pytest.approx(np.sqrt(np.diag(S)), rel=1e-7)


def test_a_given_start_is_taken_once_and_the_past_input_moves_the_estimate():
    block = printed(given_start=True).block(0.01)
    names = [s.name for s in block.inputs]
    assert names[2:] == ["initial_angle_deviation", "initial_speed"]
    first, second = run(block, np.array([[9.0, 0.4, 1.3, 0.4], [0.5, 0.0, -7.0, -7.0]]))
    assert first[:2].tolist() == [1.3, 0.4]  # no innovation, and the input before it moves nothing
    moved = np.array([1.3, 0.4]) + 0.01 * kernel(machine_rate, np.array([1.3, 0.4]), 0.5, 2)
    assert second[4] == pytest.approx(0.0 - moved[1], abs=2e-3)


def test_compiled_equals_interpreted():
    rng = np.random.default_rng(3)
    assert_bit_equal(
        printed(process_noise=(0.1,), robust=0.05).block(0.01), rng.normal(size=(300, 2))
    )


def test_faults_are_found_when_described():
    for changes, match in (({"measured": ("angle",)}, "measured"), ({"start": (0.0,)}, "x_0"),
                           ({"noise_intensity": (0.0,)}, "noise_intensity")):  # fmt: skip
        with pytest.raises(ControllerError, match=match):
            printed(**changes)
