"""∂h/∂θ and ∂h/∂x against central differences, scaled: below 1e-6 for every kind of membership.

Random models, seed = number of the case: shared sets on a grid (two outputs), and the paper's
form with own sets and 3 rules for one output, 2 for the other. Points keep away from kinks,
where there is no derivative.
"""

import numpy as np
import pytest

from controllers.fuzzy.inference import Membership, Rule
from controllers.fuzzy.membership import KINDS
from controllers.fuzzy.takagi_sugeno import TakagiSugeno, grid, partition, scattered

STEP = 1e-6


def own(kind: str, rng: np.random.Generator) -> Membership:
    c, (w, v) = rng.uniform(-0.5, 0.5), rng.uniform(1.0, 2.0, 2)
    parameters = {
        "triangular": (c, w, v),
        "trapezoidal": (c - 0.2, c + 0.2, w, v),
        "gaussian": (c, w),
        "sigmoidal": (c, rng.choice([-1.0, 1.0]) * w),
    }
    return Membership(kind, parameters[kind])


def models(kind: str, rng: np.random.Generator) -> tuple[TakagiSugeno, TakagiSugeno]:
    shared = grid([partition(kind, 3), partition(kind, 2), ()], np.zeros((2, 4)))
    antecedents = [[[own(kind, rng) for _ in range(3)] for _ in range(m)] for m in (3, 2)]
    alone = scattered(antecedents, [rng.normal(size=(m, 4)).tolist() for m in (3, 2)])
    theta = shared.theta()
    theta[shared.n_antecedent :] = rng.normal(size=len(theta) - shared.n_antecedent)
    return shared.with_theta(theta), alone


def kinks(model: TakagiSugeno, j: int) -> np.ndarray:
    """Places of the kinks of the functions of input j."""
    places: list[float] = []
    for f in model.inputs[j]:
        q = f.parameters
        if f.kind == "triangular":
            places += [q[0], q[0] - q[1], q[0] + q[2]]
        if f.kind == "trapezoidal":
            places += [q[0], q[1], q[0] - q[2], q[1] + q[3]]
    return np.array(places)


def smooth_point(model: TakagiSugeno, rng: np.random.Generator) -> np.ndarray:
    while True:
        x = rng.uniform(-1.0, 1.0, len(model.inputs))
        distances = [np.abs(x[j] - kinks(model, j)) for j in range(len(x))]
        if all(len(d) == 0 or d.min() > 1e-3 for d in distances):
            return x


def differences(model: TakagiSugeno, x: np.ndarray) -> np.ndarray:
    columns, theta = [], model.theta()
    for i, value in enumerate(theta):
        h = STEP * max(1.0, abs(value))
        up, down = theta.copy(), theta.copy()
        up[i], down[i] = value + h, value - h
        high, low = (model.with_theta(t).evaluate(x[None])[0] for t in (up, down))
        columns.append((high - low) / (up[i] - down[i]))
    return np.array(columns).T


@pytest.mark.parametrize("implication", ["product", "min"])
@pytest.mark.parametrize("kind", KINDS)
def test_derivatives_to_parameters_and_inputs(kind: str, implication: str) -> None:
    for case in range(5):
        rng = np.random.default_rng(case)
        for made in models(kind, rng):
            model = TakagiSugeno(made.inputs, made.models, made.rules, implication)
            x = smooth_point(model, rng)
            expected = differences(model, x)
            scale = max(1.0, np.abs(expected).max())
            assert np.abs(model.jacobian(x) - expected).max() / scale < 1e-6
            steps = STEP * np.eye(len(x))
            slopes = [(model.evaluate((x + e)[None]) - model.evaluate((x - e)[None]))[0] / 2 / STEP
                      for e in steps]  # fmt: skip
            assert np.abs(model.slopes(x) - np.array(slopes).T).max() / scale < 1e-6


def test_where_no_rule_fires_there_is_no_derivative() -> None:
    narrow = Membership("triangular", (0.0, 0.1, 0.1))
    model = TakagiSugeno(((narrow,),), (((1.0, 2.0),),), (Rule((0,), (0,)),))
    assert np.isnan(model.evaluate(np.array([[0.5]]))).all()
    assert not model.jacobian([0.5]).any()
    assert not model.slopes([0.5]).any()
    np.testing.assert_array_equal(model.evaluate(np.array([[0.05]])), [[1.1]])


def test_one_rule_without_sets_is_a_linear_model() -> None:
    model = grid([(), ()], [[1.0, 2.0, -3.0]])
    np.testing.assert_array_equal(model.evaluate(np.array([[0.5, 0.25]])), [[1.25]])
    np.testing.assert_array_equal(model.jacobian([0.5, 0.25]), [[1.0, 0.5, 0.25]])


@pytest.mark.parametrize("kind", ["triangular", "trapezoidal"])
def test_a_partition_of_lines_sums_to_one_everywhere(kind: str) -> None:
    model = grid([partition(kind, 4)], [[0.0, 0.0]])
    ones = model.system()
    weights = np.array([[1.0, 0.0]] * 4).ravel()
    theta = np.concatenate([model.theta()[: model.n_antecedent], weights])
    assert ones.n_weights == 4
    values = model.with_theta(theta).evaluate(np.linspace(-5.0, 5.0, 41)[:, None])
    np.testing.assert_allclose(values, 1.0, rtol=1e-15)
