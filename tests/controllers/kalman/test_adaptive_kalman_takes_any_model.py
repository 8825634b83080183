"""The filter block with another model: nonlinear, three states, two measurements, two inputs."""

import math

import numpy as np
import pytest

from controllers.core.block import Array, Signal
from controllers.core.errors import ControllerError
from controllers.kalman.adaptive_kalman import KalmanModel, Noise, kalman_block
from controllers.kalman.gain_adaptation import GainAdaptation
from tests.controllers.compiled import assert_bit_equal

T = 0.1
Q, R = np.diag([1e-3, 2e-3, 1e-4]), np.array([[0.04, 0.01], [0.01, 0.09]])


def transition(p: Array, s: Array, x: Array, u: Array, following: Array, F: Array, work: Array):
    """A unicycle: speed u_0 scaled by s, turn rate u_1."""
    step = p[0] * s[0] * u[0]
    following[0] = x[0] + step * math.cos(x[2])
    following[1] = x[1] + step * math.sin(x[2])
    following[2] = x[2] + p[0] * u[1]
    for i in range(9):
        F[i] = 0.0
    F[0] = F[4] = F[8] = 1.0
    F[2] = -step * math.sin(x[2])
    F[5] = step * math.cos(x[2])


def measurement(p: Array, s: Array, x: Array, z: Array, H: Array):
    """Distance from the origin, and the heading."""
    z[0] = math.sqrt(x[0] * x[0] + x[1] * x[1])
    z[1] = x[2]
    for i in range(6):
        H[i] = 0.0
    H[0] = x[0] / z[0]
    H[1] = x[1] / z[0]
    H[5] = 1.0


def signals(*names):
    return tuple(Signal(name) for name in names)


MODEL = KalmanModel(
    transition=transition, measurement=measurement, parameters=np.array([T]), work=0,
    states=signals("x", "y", "heading"), measured=signals("distance_z", "heading_z"),
    inputs=signals("speed", "turn"), scheduled=signals("slip"),
)  # fmt: skip
START = Noise(Q=Q, R=R, P=0.5 * np.eye(3), x=np.array([2.0, 1.0, 0.3]))


def textbook(inputs, g=1.0):
    """The extended Kalman filter by numpy; a command held since the sample before."""
    x, P, before, rows = START.x.copy(), START.P.copy(), np.zeros(2), []
    z, H, F, following = np.zeros(2), np.zeros(6), np.zeros(9), np.zeros(3)
    for k, row in enumerate(inputs):
        if k:
            transition(np.array([T]), row[4:], x, before, following, F, np.zeros(0))
            x, J = following.copy(), F.reshape(3, 3)
            P = J @ P @ J.T + Q
        measurement(np.array([T]), row[4:], x, z, H)
        M = H.reshape(2, 3)
        K = P @ M.T @ np.linalg.inv(M @ P @ M.T + R)
        x = x + g * K @ (row[:2] - z)
        L = np.eye(3) - g * K @ M
        P = L @ P @ L.T + g * g * K @ R @ K.T
        before = row[2:4]
        rows.append(np.concatenate([x, (g * K).ravel(), np.diag(P)]))
    return np.array(rows)


@pytest.mark.parametrize("g", [1.0, 0.4])
def test_it_is_the_extended_kalman_filter(g):
    rng = np.random.default_rng(8)
    inputs = np.column_stack(
        [
            2.0 + 0.3 * rng.normal(size=120), 0.3 + 0.1 * rng.normal(size=120),
            rng.uniform(0.0, 1.0, 120), rng.normal(size=120), rng.uniform(0.8, 1.0, 120),
        ]
    )  # fmt: skip
    constant = GainAdaptation(distances=(0.0, 1.0), gains=(g, g), window=3)
    block = kalman_block(MODEL, START, adaptation=None if g == 1.0 else constant)
    rows = assert_bit_equal(block, inputs)
    names = [signal.name for signal in block.outputs]
    wanted = [
        "x",
        "y",
        "heading",
        *(n for n in names if n.startswith("gain_") and "factor" not in n),
    ]
    wanted += [n for n in names if n.startswith("variance")]
    found = rows[:, [names.index(n) for n in wanted]]
    assert found == pytest.approx(textbook(inputs, g), rel=1e-9, abs=1e-12)


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(ControllerError, match="Q"):
        kalman_block(MODEL, Noise(Q=np.eye(2), R=R, P=START.P, x=START.x))
    with pytest.raises(ControllerError, match="input_share"):
        kalman_block(MODEL, START, input_share=1.5)
