"""The reduced vector (49): which components, that the others rest, and agreement with the full."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.fuzzy.inference import memberships
from controllers.papers.ahn2009.fuzzy_pid import LABELS, TABLE_2, FuzzyPID
from controllers.papers.ahn2009.tuned_fuzzy_pid import TunedFuzzyPID
from controllers.papers.ahn2009.tuned_step import THETA, tuned
from controllers.papers.ahn2009.tuner import active_components, change_active_set

BASE = FuzzyPID(kp=(0, 1), ki=(0, 1), kd=(0, 1), error_range=1.0, error_rate_range=1.0)
SYSTEM = BASE.system("p")
FIELDS = {
    "kp": (1e-4, 5e-4),
    "ki": (1e-4, 1e-3),
    "kd": (0.0, 1e-5),
    "error_range": 2000.0,
    "error_rate_range": 2e5,
    "sensitivity_bounds": (400.0, 400.0),
    "r": 1e4,
}


def chosen(x: tuple[float, float]) -> set[int]:
    mu, index, s = np.zeros(10), np.zeros(12), SYSTEM.structure()
    memberships(s, SYSTEM.theta(), np.array(x), mu)
    count = active_components(s, SYSTEM.theta(), np.array(x), mu, index)
    assert len(set(index[:count])) == count
    return {int(i) for i in index[:count]}


def test_components_by_hand() -> None:
    # |e| = 0.3 lies right of VS (1) and left of S (2), |de| = 0.6 right of S (2), left of M (3).
    triangles = {3, 5, 6, 7, 15 + 6, 15 + 8, 15 + 9, 15 + 10}
    labels = {TABLE_2[i][j][0] for i in (1, 2) for j in (2, 3)}
    assert chosen((0.3, 0.6)) == triangles | {30 + LABELS.index(label) for label in labels}


@given(x=st.tuples(st.floats(0, 1), st.floats(0, 1)))
def test_never_more_than_twelve(x: tuple[float, float]) -> None:
    assert 5 <= len(chosen(x)) <= 12


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 1000), kept=st.integers(0, 8))
def test_leaving_components_keep_variance_and_lose_correlation(seed: int, kept: int) -> None:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(8, 8))
    before = root @ root.T
    P, active = before.ravel().copy(), np.ones(8)
    index = rng.permutation(8).astype(float)
    change_active_set(8, P, active, index, kept)
    after, stays = P.reshape(8, 8), np.isin(np.arange(8), index[:kept])
    both = np.outer(stays, stays) | np.eye(8, dtype=bool)
    np.testing.assert_array_equal(after, np.where(both, before, 0.0))
    np.testing.assert_array_equal(active, stays.astype(float))
    assert np.linalg.eigvalsh(after)[0] > -1e-12 * np.trace(before)


def theta_after(vector: str, error: float, samples: int) -> np.ndarray:
    block = TunedFuzzyPID(vector=vector, alignment="paper", **FIELDS).block(0.01)
    p, x, y = block.parameters, block.state.copy(), np.zeros(len(block.outputs))
    for _ in range(samples):
        block.step(p, x, np.array([error, 0.0]), y)
    return tuned(p, x, THETA).reshape(3, 35)


def test_first_step_equals_the_full_vector_and_the_rest_rests() -> None:
    # From P = 0 both filters see the same H: components outside the set have H = 0.
    start = TunedFuzzyPID(**FIELDS).thetas().reshape(3, 35)
    full, reduced = theta_after("full", 700.0, 1), theta_after("reduced", 700.0, 1)
    np.testing.assert_allclose(reduced, full, rtol=1e-13, atol=1e-15)
    rest = sorted(set(range(35)) - chosen((0.35, 0.0)))
    assert np.array_equal(theta_after("reduced", 700.0, 40)[0, rest], start[0, rest])
    assert not np.array_equal(reduced[0], start[0])
