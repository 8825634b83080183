"""Robust against plain filter on one linear model: contaminated noise, Gaussian noise, one outlier.

Local level with drift, measured with noise of which 10 % has fifteen times the deviation; both
filters are told the variance of the clean part. 60 seeds, 300 samples each, paired.
"""

import numpy as np
import pytest
from scipy.stats import t as student

from controllers.kalman.extended_kalman import predicted, updated
from controllers.kalman.p_point import PPoint, gaussian_score

F = np.array([[1.0, 0.1], [0.0, 1.0]])
H, Q, R = np.array([[1.0, 0.0]]), np.diag([1e-4, 1e-3]), np.array([[1.0]])
SEEDS, SAMPLES = 60, 300


def squared_errors(contamination: float) -> np.ndarray:
    """Mean squared error of the level, (SEEDS, 2) for plain and robust."""
    scores = (gaussian_score(), PPoint(0.05).score())
    errors = np.zeros((SEEDS, 2))
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        wide = np.where(rng.random(SAMPLES) < contamination, 15.0, 1.0)
        noise = wide * rng.normal(size=SAMPLES)
        x, means, P = np.zeros(2), [np.zeros(2), np.zeros(2)], [np.eye(2), np.eye(2)]
        for k in range(SAMPLES):
            x = F @ x + np.sqrt(np.diag(Q)) * rng.normal(size=2)
            for f, q in enumerate(scores):
                prior, mean = predicted(P[f], F, Q), F @ means[f]
                step = updated(mean, prior, x[:1] + noise[k] - mean[:1], H, R, q)
                means[f], P[f] = step.x, step.P
                errors[seed, f] += (step.x[0] - x[0]) ** 2 / SAMPLES
    return errors


def interval(ratio: np.ndarray) -> tuple[float, float]:
    """99 % interval of the mean of log ratios, as ratios."""
    logs = np.log(ratio)
    half = student.ppf(0.995, len(logs) - 1) * logs.std(ddof=1) / np.sqrt(len(logs))
    return float(np.exp(logs.mean() - half)), float(np.exp(logs.mean() + half))


def test_under_contaminated_noise_the_robust_filter_wins() -> None:
    errors = squared_errors(0.10)
    low, high = interval(errors[:, 1] / errors[:, 0])
    assert high < 0.5, (low, high)


def test_under_gaussian_noise_it_costs_little() -> None:
    # At the Gaussian the p-point score with p = 0.05 loses a few per cent in efficiency.
    errors = squared_errors(0.0)
    low, high = interval(errors[:, 1] / errors[:, 0])
    assert high < 1.05, (low, high)


@pytest.mark.parametrize("outlier", [10.0, 1e3, 1e9])
def test_one_outlier_moves_the_robust_estimate_by_at_most_its_bound(outlier: float) -> None:
    P, x = np.diag([0.4, 0.2]), np.zeros(2)
    q = PPoint(0.05).score()
    robust = updated(x, P, np.array([outlier]), H, R, q).x
    gain = P @ H.T[:, 0] / np.sqrt(1.4)
    np.testing.assert_allclose(robust, gain * q[4], rtol=1e-12)
    plain = updated(x, P, np.array([outlier]), H, R).x
    np.testing.assert_allclose(plain, gain * outlier / np.sqrt(1.4), rtol=1e-12)


def test_inside_gamma_p_the_step_is_the_tangent_of_the_innovation() -> None:
    five = PPoint(0.05)
    P, nu = np.array([[3.0]]), 0.8
    gamma = nu / 2.0  # S = 3 + 1
    moved = updated(np.zeros(1), P, np.array([nu]), np.ones((1, 1)), R, five.score()).x[0]
    c = five.s_m * five.gamma_p
    assert moved == pytest.approx(3.0 / 2.0 * np.tan(gamma / (2 * c)) / c, rel=1e-13)
