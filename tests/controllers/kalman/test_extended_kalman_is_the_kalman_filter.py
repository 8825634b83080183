"""The plain filter against the textbook, the Riccati equation and batch least squares."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import solve_discrete_are

from controllers.kalman.extended_kalman import predicted, updated


def system(n: int, m: int, seed: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    F = rng.normal(size=(n, n))
    F *= 0.95 / np.max(np.abs(np.linalg.eigvals(F)))
    roots = rng.normal(size=(n, n)), rng.normal(size=(m, m))
    Q, R = (a @ a.T + 0.1 * np.eye(len(a)) for a in roots)
    return F, rng.normal(size=(m, n)), Q, R


cases = given(n=st.integers(1, 5), m=st.integers(1, 3), seed=st.integers(0, 10_000))


@settings(max_examples=30, deadline=None)
@cases
def test_steady_covariance_solves_the_riccati_equation(n: int, m: int, seed: int) -> None:
    F, H, Q, R = system(n, m, seed)
    P = np.zeros((n, n))
    for _ in range(400):
        prior = predicted(P, F, Q)
        P = updated(np.zeros(n), prior, np.zeros(m), H, R).P
    expected = solve_discrete_are(F.T, H.T, Q, R)
    np.testing.assert_allclose(prior, expected, rtol=1e-8, atol=1e-9 * np.trace(expected))


@settings(max_examples=50, deadline=None)
@cases
def test_one_step_equals_the_textbook(n: int, m: int, seed: int) -> None:
    F, H, Q, R = system(n, m, seed)
    rng = np.random.default_rng(seed + 1)
    x, nu, P = rng.normal(size=n), rng.normal(size=m), Q + np.eye(n)
    prior = predicted(P, F, Q)
    np.testing.assert_allclose(prior, F @ P @ F.T + Q, rtol=1e-12, atol=1e-12)
    S = H @ prior @ H.T + R
    K = prior @ H.T @ np.linalg.inv(S)
    got = updated(x, prior, nu, H, R)
    scale = float(np.max(np.abs(prior)))
    np.testing.assert_allclose(got.x, x + K @ nu, atol=1e-9 * scale)
    np.testing.assert_allclose(got.P, (np.eye(n) - K @ H) @ prior, atol=1e-9 * scale)
    squared = nu @ np.linalg.solve(S, nu)
    np.testing.assert_allclose(got.normalised_innovation_squared, squared, rtol=1e-8)
    np.testing.assert_allclose(got.gamma @ got.gamma, squared, rtol=1e-8)


def test_constant_state_equals_batch_least_squares() -> None:
    rng = np.random.default_rng(3)
    n, count, r, p0 = 4, 200, 0.25, 9.0
    H, truth = rng.normal(size=(count, n)), rng.normal(size=n)
    y = H @ truth + rng.normal(0.0, np.sqrt(r), count)
    x, P = np.zeros(n), p0 * np.eye(n)
    for row, value in zip(H, y, strict=True):
        step = updated(x, P, np.array([value - row @ x]), row[None, :], np.array([[r]]))
        x, P = step.x, step.P
    information = H.T @ H / r + np.eye(n) / p0
    np.testing.assert_allclose(x, np.linalg.solve(information, H.T @ y / r), rtol=1e-10)
    np.testing.assert_allclose(P, np.linalg.inv(information), rtol=1e-9, atol=1e-14)


def test_normalised_innovation_of_a_matched_filter_is_chi_square() -> None:
    # mean m = 2; 20 000 correlated-free samples: standard error of the mean √(2m/N) = 0.0141.
    rng = np.random.default_rng(11)
    F, H, Q, R = system(3, 2, 5)
    x, estimate, P, total, count = np.zeros(3), np.zeros(3), np.eye(3), 0.0, 20_000
    root_q, root_r = np.linalg.cholesky(Q), np.linalg.cholesky(R)
    x = rng.normal(size=3)
    for _ in range(count):
        x = F @ x + root_q @ rng.normal(size=3)
        P = predicted(P, F, Q)
        innovation = H @ x + root_r @ rng.normal(size=2) - H @ (F @ estimate)
        step = updated(F @ estimate, P, innovation, H, R)
        estimate, P = step.x, step.P
        total += step.normalised_innovation_squared
    assert abs(total / count - 2.0) < 4 * 0.0141


def test_singular_innovation_covariance_updates_nothing_and_says_nan() -> None:
    zero = np.zeros((1, 1))
    got = updated(np.ones(1), zero, np.ones(1), np.ones((1, 1)), zero)
    assert np.isnan(got.normalised_innovation_squared)
    assert got.x[0] == 1.0
