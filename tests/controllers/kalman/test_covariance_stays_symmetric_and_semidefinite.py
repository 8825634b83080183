"""Symmetric to the bit, and no eigenvalue below zero beyond rounding, plain and robust."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.kalman.extended_kalman import predicted, updated
from controllers.kalman.p_point import ALPHA_E, FACTOR, PPoint, gaussian_score
from controllers.papers.ahn2009.tuned_fuzzy_pid import TunedFuzzyPID
from controllers.papers.ahn2009.tuned_step import COVARIANCE, tuned

EPS = np.finfo(float).eps


def assert_covariance(P: np.ndarray, scale: float) -> None:
    """`scale` is the largest eigenvalue before the update: what is rounded is P⁻."""
    assert np.array_equal(P, P.T)
    assert np.linalg.eigvalsh(P)[0] >= -20 * len(P) * EPS * scale


@settings(max_examples=40, deadline=None)
@given(
    n=st.integers(1, 6),
    m=st.integers(1, 3),
    p=st.sampled_from([None, 1e-4, 0.05, 0.5]),
    exponent=st.integers(-14, 2),
    seed=st.integers(0, 10_000),
)
def test_long_runs_with_nearly_perfect_measurements(n, m, p, exponent, seed) -> None:
    rng = np.random.default_rng(seed)
    q = gaussian_score() if p is None else PPoint(p).score()
    P, R = np.eye(n) * 10.0 ** rng.integers(-6, 7), np.eye(m) * 10.0**exponent
    for _ in range(60):
        F = np.eye(n) + 0.1 * rng.normal(size=(n, n))
        P = predicted(P, F, np.diag(rng.random(n) * 1e-3))
        scale = np.linalg.eigvalsh(P)[-1]
        assert_covariance(P, scale)
        P = updated(np.zeros(n), P, rng.normal(size=m), rng.normal(size=(m, n)), R, q).P
        assert_covariance(P, scale)


@given(p=st.floats(1e-6, 0.999), seed=st.integers(0, 1000))
def test_the_sum_of_squares_is_equation_31(p: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, m, q = 4, 2, PPoint(p).score()
    root = rng.normal(size=(n, n))
    P, H, R = root @ root.T, rng.normal(size=(m, n)), np.diag([0.5, 2.0])
    K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
    expected = (np.eye(n) - q[FACTOR] * K @ H) @ P
    got = updated(np.zeros(n), P, np.zeros(m), H, R, q).P
    np.testing.assert_allclose(got, expected, atol=1e-12 * np.trace(P))
    assert 0 < q[ALPHA_E] < 1


@pytest.mark.parametrize("vector", ["reduced", "full"])
@pytest.mark.parametrize("filter_name", ["ekf", "robust_ekf"])
def test_tuner_covariances_over_a_run(vector: str, filter_name: str) -> None:
    controller = TunedFuzzyPID(
        kp=(1e-4, 5e-4),
        ki=(0.0, 1e-3),
        kd=(0.0, 1e-5),
        error_range=2000.0,
        error_rate_range=2e5,
        sensitivity_bounds=(100.0, 1000.0),
        r=1.0,
        filter=filter_name,
        vector=vector,
    )
    block = controller.block(0.01)
    p, x, y = block.parameters.copy(), block.state.copy(), np.zeros(len(block.outputs))
    rng = np.random.default_rng(4)
    level = 0.0
    for k in range(150):
        level = 0.9 * level + rng.normal(0.0, 500.0)
        block.step(p, x, np.array([1000.0, 1000.0 + level]), y)
        for axis in range(3) if k % 5 == 0 else ():
            P = tuned(p, x, COVARIANCE).reshape(3, 35, 35)[axis]
            assert_covariance(P, np.linalg.eigvalsh(P)[-1])
    assert np.all(y[[s.name.startswith("p_trace") for s in block.outputs]] > 0)
