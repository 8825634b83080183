"""Why the printed filter fails: two rests with the same measured speed and the same control.

A pair (x̂, x) of angles, both at rest under the u that the controller computes of x̂, gives no
innovation: a filter that measures the speed stays at x̂ whatever its gain, and the machine at x.
"""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from controllers.papers.takata.kalman_bucy import KalmanBucy
from controllers.papers.takata.machine_model import (
    MachineParameters,
    machine_jacobian,
    machine_rate,
)
from controllers.state_space.lq_regulator import LQRegulator
from tests.controllers.compiled import run

MODEL = "controllers.papers.takata.machine_model:MachineParameters"
P = MachineParameters().model().parameters
REST = float(P[4])
K = float(LQRegulator(model=MODEL, Q=(1.0, 1.0), R=(1.0,)).design.K[0, 0])


def false_rest(low, high):
    """A rest x̂ of the LQ loop between low and high, its u, and where a machine rests under u."""
    estimate = brentq(lambda x: math.sin(x + REST) * (1 - K * x) - 0.8, low, high, xtol=1e-15)
    u = -K * estimate
    return estimate, u, math.asin(0.8 / (1 + u)) - REST


def test_the_saddle_looks_like_the_rest():
    rate = np.empty(2)
    for angle in (0.0, math.pi - 2 * REST):
        machine_rate(P, np.array([angle, 0.0]), np.zeros(1), rate)
        assert np.abs(rate).max() < 1e-14


@pytest.mark.parametrize(("low", "high"), [(1.5, 2.0), (5.0, 6.0), (11.0, 12.0)])
def test_a_false_rest_lasts(low, high):
    estimate, u, angle = false_rest(low, high)
    assert abs(estimate - angle) > 1.0
    rate, slope = np.empty(2), np.empty(4)
    machine_rate(P, np.array([angle, 0.0]), np.array([u]), rate)
    machine_jacobian(P, np.array([angle, 0.0]), np.array([u]), slope)
    assert np.abs(rate).max() < 1e-12
    assert slope[2] < 0.0  # the machine rests there stably, so it stays
    filter_ = KalmanBucy(model=MODEL, measured=("speed",), noise_intensity=(1.0,),
                         start=(estimate, 0.0), covariance=(0.0, 0.0))  # fmt: skip
    rows = run(filter_.block(0.01), np.tile([u, 0.0], (100, 1)))
    assert np.abs(rows[:, 0] - estimate).max() < 1e-9
    assert np.abs(rows[:, 4]).max() < 1e-9


def test_the_nearest_false_rest_of_the_machine():
    """The |x| = 0.490 at which a tenth of figure 3's runs with the LQ controller end."""
    assert false_rest(1.5, 2.0)[2] == pytest.approx(-0.490, abs=5e-4)
