"""What the identifier finds of plants that are known: coefficients, sensitivity, benchmark.

Seeds are those given; the linear plant is y_{k+1} = 1.5·y_k − 0.6·y_{k−1} + 0.8·u_k, in units
whose ranges differ and have offsets.
"""

import numpy as np

from controllers.identification.identifier import Identifier
from controllers.identification.narx import Lags, fit
from controllers.papers.barragan.narendra_parthasarathy import NarendraParthasarathy
from tests.controllers.compiled import run


def linear(n: int) -> np.ndarray:
    """Rows (y_k, u_{k−1})."""
    u, y = np.random.default_rng(7).uniform(2.0, 6.0, n), np.zeros(n)
    for k in range(n - 1):
        y[k + 1] = 1.5 * y[k] - 0.6 * (y[k - 1] if k else 0.0) + 0.8 * u[k]
    return np.column_stack([y, np.concatenate([[0.0], u[:-1]])])


def test_linear_plant_in_physical_units() -> None:
    identifier = Identifier(
        measured_ranges=((0.0, 60.0),), exogenous_ranges=((2.0, 6.0),), measured_units=("N",),
        exogenous_units=("V",), exogenous_lags=1, noise_std=(1e-6,), consequent_std=10.0,
    )  # fmt: skip
    block = identifier.block(0.01)
    names = [s.name for s in block.outputs]
    units = {s.name: s.unit for s in block.outputs}
    rows = run(block, linear(120))
    assert abs(rows[-1, names.index("sensitivity_y_u")] - 0.8) < 1e-8
    assert units["sensitivity_y_u"] == "N/V"
    assert np.abs(rows[60:, names.index("y_innovation")]).max() < 1e-7


def test_start_is_persistence_with_the_given_sensitivity() -> None:
    identifier = Identifier(
        measured_ranges=((-10.0, 30.0),), exogenous_ranges=((0.0, 5.0),), memberships={"y_1": 3},
        start_sensitivity=((2.5,),), learn_from=1e9,
    )  # fmt: skip
    block = identifier.block(1.0)
    inputs = np.array([[3.0, 0.0], [7.0, 1.0], [4.0, 2.0], [6.0, 0.0]])
    rows = run(block, inputs)
    names = [s.name for s in block.outputs]
    np.testing.assert_allclose(rows[2:, names.index("y_predicted")], [7.0 + 5.0, 4.0], rtol=1e-12)
    np.testing.assert_allclose(rows[:, names.index("sensitivity_y_u")], 2.5, rtol=1e-12)


def test_sensitivity_keeps_its_bounds() -> None:
    identifier = Identifier(
        measured_ranges=((0.0, 60.0),), exogenous_ranges=((2.0, 6.0),), exogenous_lags=1,
        noise_std=(1e-3,), start_sensitivity=((0.3,),), sensitivity_bounds=(0.1, 0.5),
    )  # fmt: skip
    block = identifier.block(0.01)
    rows = run(block, linear(60))
    found = rows[:, [s.name for s in block.outputs].index("sensitivity_y_u")]
    assert found.min() >= 0.1 - 1e-12
    assert found.max() <= 0.5 + 1e-12
    assert found[-1] > 0.5 - 1e-9  # the true one is 0.8


def test_benchmark_plant_is_its_difference_equation() -> None:
    block = NarendraParthasarathy(start=(0.5, -0.25)).block(1.0)
    u = np.random.default_rng(0).uniform(-2.0, 2.0, 50)
    y = run(block, u[:, None])[:, 0]
    assert y[0] == 0.5
    before = np.concatenate([[-0.25], y[:-2]])
    now = y[:-1]
    expected = now * before * (now + 2.5) / (1.0 + now**2 + before**2) + u[:-1]
    np.testing.assert_allclose(y[1:], expected, rtol=1e-14)


def test_free_run_of_the_true_model_is_the_series() -> None:
    rows = linear(50)
    y, u = rows[:, :1], np.concatenate([rows[1:, 1:], [[0.0]]])
    lags, coefficients = Lags(1, 1, 2, 1), np.array([1.5, -0.6, 0.8])
    X, Y = lags.rows(y, u)
    np.testing.assert_allclose(X @ coefficients, Y[:, 0], rtol=1e-12)
    small = 0.05  # inside the limit of a free run
    made = lags.free_run(lambda x: x @ coefficients[:, None], small * y, small * u)
    np.testing.assert_allclose(made, small * y, rtol=1e-9)
    assert fit(y, y) == 100.0
    assert abs(fit(y, np.full_like(y, y.mean()))) < 1e-12


def test_measured_without_a_value_shows_at_once_and_from_then_on() -> None:
    block = Identifier(measured_ranges=((0.0, 60.0),), exogenous_ranges=((2.0, 6.0),)).block(0.01)
    names = [s.name for s in block.outputs]
    inputs = linear(20)
    inputs[10, 0] = np.nan
    rows = run(block, inputs)
    assert np.isfinite(rows[:10]).all()
    assert np.isnan(rows[10:, names.index("y_innovation")]).all()
    assert np.isnan(rows[11:, names.index("y_predicted")]).all()
