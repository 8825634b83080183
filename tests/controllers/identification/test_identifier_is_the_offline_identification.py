"""The block on a time series against the offline functions on its rows; compiled, bit for bit.

Two outputs with two lags, one input with two lags, sets on two regressors; 120 samples, seed 5.
"""

import numpy as np

from controllers.identification.identifier import Identifier
from controllers.identification.narx import Lags
from controllers.identification.offline import identify
from tests.controllers.compiled import assert_bit_equal, run

N, LEARNT, FREE = 120, 80, 90
IDENTIFIER = Identifier(
    measured=("level", "flow"), exogenous=("valve",),
    measured_ranges=((-3.0, 5.0), (-2.0, 2.0)), exogenous_ranges=((-1.0, 1.0),),
    exogenous_lags=2, memberships={"level_1": 3, "valve_2": 2}, noise_std=(0.1, 0.1),
    learn_until=0.1 * LEARNT, free_run_from=0.1 * FREE,
)  # fmt: skip


def series() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(5)
    u, y = rng.uniform(-1.0, 1.0, (N, 1)), np.zeros((N, 2))
    for k in range(1, N - 1):
        level, flow = y[k]
        y[k + 1] = 0.7 * level + np.tanh(flow) + u[k, 0], 0.5 * flow - 0.2 * y[k - 1, 0]
    return y + rng.normal(0.0, 0.02, y.shape), u


def rows_of(block_inputs: np.ndarray) -> tuple[list[str], np.ndarray]:
    block = IDENTIFIER.block(0.1)
    return [s.name for s in block.outputs], run(block, block_inputs)


def inputs() -> np.ndarray:
    y, u = series()
    return np.column_stack([y, np.vstack([np.zeros((1, 1)), u[:-1]])])  # u_{k−1} at instant k


def test_predictions_and_parameters_are_those_of_identify() -> None:
    names, made = rows_of(inputs())
    y, u = series()
    scales, start = IDENTIFIER.scales(), IDENTIFIER.start_model()
    pairs = zip(scales, np.hstack([y, u]).T, strict=True)
    scaled = np.column_stack([scale.scaled(column) for scale, column in pairs])
    X, Y = Lags(2, 1, 2, 2).rows(scaled[:, :2], scaled[:, 2:])
    learnt = slice(0, LEARNT - 2)
    found = identify(start, X[learnt], Y[learnt], IDENTIFIER.adapted())
    column = names.index("level_predicted")
    predicted = scales[0].physical(found.predicted[:, 0])
    np.testing.assert_allclose(made[2:LEARNT, column], predicted, rtol=1e-12, atol=1e-12)
    at = names.index(start.parameter_names()[0])
    np.testing.assert_allclose(made[-1, at:], found.model.theta(), rtol=1e-12)
    np.testing.assert_array_equal(made[LEARNT:, at:], np.tile(made[-1, at:], (N - LEARNT, 1)))
    run_scaled = Lags(2, 1, 2, 2).free_run(
        found.model.evaluate, scaled[FREE - 2 :, :2], scaled[FREE - 2 :, 2:]
    )
    simulated = scales[1].physical(run_scaled[2:, 1])
    column = names.index("flow_simulated")
    np.testing.assert_allclose(made[FREE:, column], simulated, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(made[:FREE, column], y[:FREE, 1], rtol=1e-12, atol=1e-15)


def test_sensitivity_is_the_slope_of_the_next_prediction() -> None:
    names, made = rows_of(inputs())
    y, u = series()
    start = IDENTIFIER.start_model()
    model = start.with_theta(made[-1, names.index(start.parameter_names()[0]) :])
    scales, changed = IDENTIFIER.scales(), []
    for du in (0.0, 1e-6):
        # the input held over the last sample is held on, with a small change
        newest = np.concatenate([y[-1, :1], y[-2, :1], y[-1, 1:], y[-2, 1:]])
        x = [(newest[:2] - 1.0) / 4.0, newest[2:] / 2.0, [u[-2, 0] + du, u[-2, 0]]]
        changed.append(scales[0].physical(model.evaluate(np.concatenate(x)[None])[0, 0]))
    slope = (changed[1] - changed[0]) / 1e-6
    found = made[-1, names.index("sensitivity_level_valve")]
    np.testing.assert_allclose(found, slope, rtol=1e-7)


def test_compiled_equals_interpreted_bit_for_bit() -> None:
    assert_bit_equal(IDENTIFIER.block(0.1), inputs())
