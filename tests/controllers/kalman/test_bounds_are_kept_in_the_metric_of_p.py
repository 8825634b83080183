"""Projection: the nearest admissible point in the metric of P, and always inside the bounds."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.identification.adaptation import Adaptation, adapt
from controllers.kalman.constraints import project

SEEDS = st.integers(0, 2**32 - 1)


def draw(seed: int, n: int = 4) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(n, n))
    return rng.normal(size=n), A @ A.T + 0.1 * np.eye(n)


@given(SEEDS)
@settings(max_examples=30, deadline=None)
def test_one_bound_gives_the_constrained_minimum(seed: int) -> None:
    x, P = draw(seed)
    bound = x[1] - 0.5
    upper = np.full(4, np.inf)
    upper[1] = bound
    z = x.copy()
    assert project(4, z, P.ravel().copy(), np.full(4, -np.inf), upper) == 1
    # stationarity on the bound: P⁻¹(z − x) is a multiple of e_1, with the sign of a multiplier
    multiplier = np.linalg.solve(P, z - x)
    assert z[1] == bound
    np.testing.assert_allclose(multiplier[[0, 2, 3]], 0.0, atol=1e-9 * abs(multiplier[1]))
    assert multiplier[1] < 0.0


@given(SEEDS)
@settings(max_examples=50, deadline=None)
def test_result_is_inside_and_inside_stays(seed: int) -> None:
    x, P = draw(seed)
    lower, upper = np.full(4, -0.3), np.full(4, 0.4)
    flat = P.ravel().copy()
    project(4, x, flat, lower, upper)
    assert (lower <= x).all()
    assert (x <= upper).all()
    again = x.copy()
    assert project(4, again, flat, lower, upper) == 0
    np.testing.assert_array_equal(again, x)
    np.testing.assert_array_equal(flat, P.ravel())


def test_without_correlation_it_clips() -> None:
    x = np.array([2.0, -3.0, 0.1])
    project(3, x, np.diag([1.0, 0.0, 4.0]).ravel(), np.full(3, -1.0), np.full(3, 1.0))
    np.testing.assert_array_equal(x, [1.0, -1.0, 0.1])


def test_adapted_parameters_keep_their_bounds_and_fixed_ones_their_values() -> None:
    rng = np.random.default_rng(4)
    adaptation = Adaptation(
        variance=np.array([1.0, 0.0, 1.0]), noise=np.array([0.1, 0.0, 0.1]), r=(0.01,),
        lower=np.array([-0.2, -np.inf, -np.inf]), upper=np.array([0.2, np.inf, np.inf]),
    )  # fmt: skip
    c, P, p = adaptation.constants(), adaptation.covariance(), np.zeros(3)
    gamma, work = np.zeros(1), np.zeros(adaptation.work())
    for _ in range(200):
        H = rng.normal(size=3)
        innovation = np.array([H @ [1.0, 0.0, 0.5] - H @ p])
        adapt(c, p, P, innovation, H, gamma, work)
        assert abs(p[0]) <= 0.2
    assert p[1] == 0.0
    assert p[0] == 0.2  # the true value is 1, beyond the bound


def test_drift_is_added_only_up_to_the_ceiling() -> None:
    adaptation = Adaptation(variance=np.ones(1), noise=np.full(1, 0.3), r=(1e6,))
    c, P, p = adaptation.constants(), np.array([0.5]), np.zeros(1)
    gamma, work = np.zeros(1), np.zeros(adaptation.work())
    variances = []
    for _ in range(5):
        adapt(c, p, P, np.zeros(1), np.zeros(1), gamma, work)  # nothing is observed
        variances.append(P[0])
    np.testing.assert_allclose(variances, [0.8, 1.0, 1.0, 1.0, 1.0], rtol=1e-12)
