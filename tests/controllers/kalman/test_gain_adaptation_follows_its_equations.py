"""(13)–(16): distance, window, scaling by the gain, and the score that carries the factor."""

import numpy as np
import pytest

from controllers.core.errors import ControllerError
from controllers.kalman.extended_kalman import updated
from controllers.kalman.gain_adaptation import (
    GainAdaptation,
    distance_work,
    innovation_distance,
    scale_score,
    state_distance,
)
from controllers.kalman.p_point import N_SCORE
from controllers.papers.serkies2013.two_mass_kalman import TwoMassKalman
from tests.controllers.compiled import run

CURVE = {"distances": (0.1, 1.0, 6.0, 30.0), "gains": (1.0, 0.4, 0.2, 0.08)}


def random_filter(seed):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(4, 4))
    return root @ root.T, rng.normal(size=(2, 4)), np.diag([0.3, 0.7]), rng.normal(size=2)


@pytest.mark.parametrize("seed", range(5))
def test_distances_are_those_of_the_inverse_matrices(seed):
    P, H, R, nu = random_filter(seed)
    work = np.empty(distance_work(4, 2))
    weights = np.diag(H @ np.linalg.inv(P) @ H.T)
    found = state_distance(4, 2, P.ravel(), H.ravel(), nu, work)
    assert found == pytest.approx(weights @ nu**2, rel=1e-10)
    found = innovation_distance(4, 2, P.ravel(), H.ravel(), R.ravel(), nu, work)
    assert found == pytest.approx(nu @ np.linalg.solve(H @ P @ H.T + R, nu), rel=1e-10)


@pytest.mark.parametrize("g", [0.1, 0.6, 1.0, 1.7])
def test_a_scaled_score_multiplies_the_gain(g):
    P, H, R, nu = random_filter(9)
    K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
    q = np.zeros(N_SCORE)
    scale_score(q, g, True)
    after = updated(np.zeros(4), P, nu, H, R, q)
    L = np.eye(4) - g * K @ H
    assert after.x == pytest.approx(g * K @ nu, rel=1e-10)
    assert np.abs(after.P - (L @ P @ L.T + g * g * K @ R @ K.T)).max() < 1e-12
    scale_score(q, g, False)
    after = updated(np.zeros(4), P, nu, H, R, q)
    assert after.x == pytest.approx(g * K @ nu, rel=1e-10)
    assert np.abs(after.P - (P - K @ H @ P)).max() < 1e-12


def test_the_curve_goes_through_its_points_and_falls_between():
    system = GainAdaptation(window=1, **CURVE).system()
    for distance, gain in zip(CURVE["distances"], CURVE["gains"], strict=True):
        assert system.evaluate(distance)[0] == gain
    assert system.evaluate(0.0)[0] == 1.0 and system.evaluate(1e9)[0] == 0.08
    assert system.evaluate(3.5)[0] == pytest.approx(0.3, rel=1e-14)
    values = [system.evaluate(d)[0] for d in np.linspace(0.0, 40.0, 2001)]
    assert np.all(np.diff(values) <= 1e-15)


def test_the_distance_is_the_mean_of_the_window_over_the_gain_before():
    """D² of each sample is taken back out of the reported means, weighs ν² by a positive number
    (the first by (P_0⁻¹)₁₁), and the factor is the curve of what is reported."""
    window = 7
    block = TwoMassKalman(
        motor_time_constant=0.2, shaft_time_constant=1e-3, q=(1e-6,) * 4, r=1e-4,
        window=window, **CURVE,
    ).block(5e-4)  # fmt: skip
    rng = np.random.default_rng(3)
    inputs = np.column_stack([0.02 * rng.normal(size=60), np.zeros(60), np.full(60, 0.2)])
    names = [signal.name for signal in block.outputs]
    rows = run(block, inputs)
    distance, gain = (rows[:, names.index(name)] for name in ("distance", "gain_factor"))
    before = np.concatenate([[1.0], gain[:-1]])
    mean = distance * before
    count = np.minimum(np.arange(1, 61), window)
    squared = np.diff(np.concatenate([[0.0], mean[:window] * count[:window]]))
    for k in range(window, 60):
        squared = np.append(squared, mean[k] * window - squared[k - window + 1 : k].sum())
    innovation = rows[:, names.index("innovation_motor_speed")]
    weight = squared / innovation**2
    assert np.all(weight > 0.0)
    assert weight[0] == pytest.approx(1e4, rel=1e-9)
    system = GainAdaptation(window=1, **CURVE).system()
    assert gain == pytest.approx([system.evaluate(d)[0] for d in distance], rel=1e-12)


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"distances": (1.0, 0.5), "gains": (1.0, 0.5)}, "ascending"),
        ({"gains": (1.0, 0.4, 0.2, 0.0)}, "between 0 and 2"),
        ({"gains": (1.0,)}, "as many"),
        ({"window": 0}, "whole number"),
        ({"distance": "euclid"}, "state"),
        ({"covariance": "none"}, "consistent"),
    ],
)
def test_faults(changed, named):
    with pytest.raises(ControllerError, match=named):
        GainAdaptation(**{"window": 5, **CURVE, **changed})
