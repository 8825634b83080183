"""The estimator block: textbook recursion, Riccati limit, open loop, bits, and refusals."""

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from controllers.core.block import Signal
from controllers.core.errors import ControllerError
from controllers.core.layout import part
from controllers.kalman.estimator import Estimator
from controllers.kalman.estimator_step import NOISE, P_IN_PARAMETERS
from controllers.kalman.extended_kalman import predicted, updated
from controllers.kalman.linear_model import linear_measurement, linear_model
from controllers.papers.raheem2013.servo_estimator import ServoEstimator
from tests.controllers.compiled import assert_bit_equal, run

rng = np.random.default_rng(8)
A = np.array([[0.9, 0.2, 0.0], [-0.1, 0.8, 0.3], [0.0, 0.1, 0.7]])
B, G = rng.normal(size=(3, 1)), rng.normal(size=(3, 2))
C, R = rng.normal(size=(2, 3)), np.array([[0.5, 0.1], [0.1, 0.3]])
Q_W = np.array([0.2, 0.7])
X_0, P_0 = np.array([1.0, -1.0, 0.5]), np.diag([1.0, 2.0, 3.0])


def signals(prefix: str, count: int) -> tuple[Signal, ...]:
    return tuple(Signal(f"{prefix}{i}") for i in range(count))


filter_of_a_map = Estimator(
    model=linear_model(signals("x", 3), signals("u", 1), signals("w", 2), A, B, G),
    measurement=linear_measurement(signals("z", 2), C, R),
    q=Q_W,
    x_0=X_0,
    P_0=P_0,
    discretisation="map",
)


def test_it_follows_the_textbook_step_by_step() -> None:
    given = rng.normal(size=(50, 3))
    rows = run(filter_of_a_map.block(1.0), given)
    x, P, Q = X_0, P_0, G @ np.diag(Q_W) @ G.T
    for k, row in enumerate(rows):
        if k > 0:
            x, P = A @ x + B @ given[k - 1, :1], predicted(P, A, Q)
        S = C @ P @ C.T + R
        nu = given[k, 1:] - C @ x
        gain = P @ C.T @ np.linalg.inv(S)
        step = updated(x, P, nu, C, R)
        x, P = step.x, step.P
        np.testing.assert_allclose(row[:3], x, rtol=1e-10)
        np.testing.assert_allclose(row[3:6], np.sqrt(np.diag(P)), rtol=1e-10)
        np.testing.assert_allclose(row[6:8], nu, rtol=1e-10, atol=1e-12)
        np.testing.assert_allclose(row[8:10], np.sqrt(np.diag(S)), rtol=1e-10)
        assert row[10] == pytest.approx(nu @ np.linalg.solve(S, nu), rel=1e-9)
        np.testing.assert_allclose(row[11:].reshape(3, 2), gain, rtol=1e-9, atol=1e-12)


def test_its_steady_gain_is_that_of_the_riccati_equation() -> None:
    rows = run(filter_of_a_map.block(1.0), np.zeros((300, 3)))
    P = solve_discrete_are(A.T, C.T, G @ np.diag(Q_W) @ G.T, R)
    gain = P @ C.T @ np.linalg.inv(C @ P @ C.T + R)
    np.testing.assert_allclose(rows[-1, 11:].reshape(3, 2), gain, rtol=1e-8, atol=1e-10)


def servo(**changed: object) -> ServoEstimator:
    given = {"sensor_std": 1e-3, "current_std": 1e-4, "force_std": 20.0, "noise_interval": 1e-4}
    return ServoEstimator(**(given | changed))  # type: ignore[arg-type]


CASES = [
    servo(),
    servo(discretisation="euler"),
    servo(measured="position", sensor_std=1e-4, substeps=2, initial_std=(1e-3, 0.0, 1e4, 0.0)),
    servo(measured="none"),
    servo(linear=True, robust=0.05),
]


@pytest.mark.parametrize("estimator", CASES)
def test_compiled_and_interpreted_are_equal_to_the_bit(estimator: ServoEstimator) -> None:
    block = estimator.block(1e-4)
    draws = np.random.default_rng(2).normal(size=(300, 2)) * [2e-4, 2e-2]
    draws[:, 0] += 1e-3
    rows = assert_bit_equal(block, draws[:, : len(block.inputs)])
    assert np.isfinite(rows).all()


def test_without_measurement_it_is_the_model_alone() -> None:
    given = np.full((400, 2), (1e-3, 0.0))
    open_loop = run(servo(measured="none").block(1e-4), given[:, :1])
    deaf = run(servo(sensor_std=1e9).block(1e-4), given)
    np.testing.assert_allclose(open_loop[:, :4], deaf[:, :4], rtol=1e-12)
    assert open_loop.shape[1] == 9


def test_white_noise_counts_with_its_intensity() -> None:
    """Noise held for 0.1 ms and a filter at 0.2 ms: variance of the mean over the sample."""
    blocks = (servo().block(sample_time).parameters for sample_time in (1e-4, 2e-4))
    single, double = (part(p[P_IN_PARAMETERS:], p, NOISE) for p in blocks)
    assert single.size == 2 and np.all(single > 0.0)
    np.testing.assert_allclose(double, single / 2, rtol=1e-12)


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"measured": "pressure"}, "servo_measurement"),
        ({"initial": (0.0, 0.0)}, "initial"),
        ({"model": {"spring": 1.0}}, "model"),
        ({"discretisation": "exact"}, "discretisation"),
        ({"substeps": 0}, "substeps"),
        ({"current_std": -1.0}, "current_std"),
    ],
)
def test_what_cannot_be_meant_is_refused(changed: dict[str, object], named: str) -> None:
    with pytest.raises(ControllerError, match=named):
        servo(**changed)


def test_noise_that_outlasts_the_sample_is_refused() -> None:
    with pytest.raises(ControllerError, match="noise_interval: expected at most"):
        servo(noise_interval=1e-3).block(1e-4)
