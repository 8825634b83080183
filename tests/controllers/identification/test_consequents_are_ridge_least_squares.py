"""Consequents only, R_v = 0: the filter is ridge least squares, in mean and covariance.

Model with two outputs, sets of every kind, three inputs; 120 rows, seed 2.
"""

import numpy as np
import pytest

from controllers.fuzzy.membership import KINDS
from controllers.fuzzy.takagi_sugeno import TakagiSugeno, grid, partition
from controllers.identification.offline import Uncertainty, identify, ridge_least_squares

R = (0.01, 0.04)
STD = 3.0


def rows() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(2)
    X = rng.uniform(-1.0, 1.0, (120, 3))
    Y = np.column_stack([np.sin(3.0 * X[:, 0]) * X[:, 1], X[:, 2] ** 2 + X[:, 0]])
    return X, Y + rng.normal(0.0, 0.1, Y.shape)


def start(kind: str) -> TakagiSugeno:
    return grid([partition(kind, 3), (), ()], [[0, 1, 0, 0], [0.5, 0, 0, 1]])


@pytest.mark.parametrize("kind", KINDS)
def test_filter_equals_batch(kind: str) -> None:
    model, (X, Y) = start(kind), rows()
    adaptation = Uncertainty(adapt="consequents", consequent_std=STD).adaptation(model, R)
    found = identify(model, X, Y, adaptation)
    n = len(adaptation.free)
    batch = ridge_least_squares(model, X, Y, R, np.full(n, STD**2))
    assert np.abs(found.model.theta() - batch.theta()).max() < 1e-7
    slopes = np.array([model.jacobian(x)[:, model.n_antecedent :] for x in X])
    weighted = slopes / np.sqrt(np.array(R))[:, None]
    information = np.eye(n) / STD**2 + np.einsum("koi,koj->ij", weighted, weighted)
    np.testing.assert_allclose(found.P, np.linalg.inv(information), rtol=0, atol=1e-9)


def test_batch_is_the_minimum() -> None:
    model, (X, Y) = start("gaussian"), rows()
    n = len(model.theta()) - model.n_antecedent
    batch = ridge_least_squares(model, X, Y, R, np.full(n, STD**2))

    def cost(theta: np.ndarray) -> float:
        residual = (Y - model.with_theta(theta).evaluate(X)) / np.sqrt(R)
        change = (theta - model.theta())[model.n_antecedent :] / STD
        return float(np.sum(residual**2) + np.sum(change**2))

    rng, least = np.random.default_rng(3), cost(batch.theta())
    for _ in range(5):
        step = np.zeros(len(model.theta()))
        step[model.n_antecedent :] = rng.normal(size=n)
        # quadratic: equal on both sides of the minimum, and above it
        up, down = (cost(batch.theta() + s * 1e-2 * step) for s in (1.0, -1.0))
        assert min(up, down) > least
        assert abs(up - down) < 1e-6 * (up - least)


def test_antecedents_stay_unless_they_are_adapted_and_then_are_found() -> None:
    rng = np.random.default_rng(4)
    start = grid([partition("gaussian", 3)], [[0.0, 0.0]])
    true = start.theta()
    true[: start.n_antecedent] += rng.uniform(-0.15, 0.15, start.n_antecedent)
    true[start.n_antecedent :] = rng.normal(size=6)
    X = rng.uniform(-1.5, 1.5, (250, 1))
    Y = start.with_theta(true).evaluate(X)
    errors = {}
    for adapt in ("consequents", "all"):
        uncertainty = Uncertainty(
            adapt=adapt, consequent_std=STD, antecedent_std=0.2,
            consequent_drift=0.01, antecedent_drift=0.01,
        )  # fmt: skip
        found = identify(start, X, Y, uncertainty.adaptation(start, (1e-6,)), passes=8)
        moved = np.abs(found.model.theta() - start.theta())[: start.n_antecedent].max()
        assert (moved == 0.0) == (adapt == "consequents")
        errors[adapt] = float(np.sqrt(np.mean((found.model.evaluate(X) - Y) ** 2)))
    assert errors["all"] < 0.05 * errors["consequents"], errors
