"""The filter kernels inside a block of three states and two measurements, bit for bit."""

import numpy as np
import pytest

from controllers.core.block import Array, Block, Signal
from controllers.kalman.extended_kalman import predict, update, update_work
from controllers.kalman.p_point import N_SCORE, PPoint, gaussian_score
from tests.controllers.compiled import assert_bit_equal

N_X, N_Z = 3, 2
P_F, P_Q, P_H, P_R, P_SCORE = 0, 9, 18, 24, 28
X_P, X_NU, X_GAMMA, X_NEXT, X_WORK = 3, 12, 14, 16, 19


def estimate(p: Array, x: Array, u: Array, y: Array) -> None:
    """A linear robust Kalman filter, as a later estimator will be written."""
    for i in range(N_X):
        x[X_NEXT + i] = 0.0
        for k in range(N_X):
            x[X_NEXT + i] = x[X_NEXT + i] + p[P_F + N_X * i + k] * x[k]
    for i in range(N_X):
        x[i] = x[X_NEXT + i]
    P = x[X_P:X_NU]
    predict(N_X, P, p[P_F:P_Q], p[P_Q:P_H], x[X_WORK:])
    for a in range(N_Z):
        x[X_NU + a] = u[a]
        for k in range(N_X):
            x[X_NU + a] = x[X_NU + a] - p[P_H + N_X * a + k] * x[k]
    y[3] = update(
        N_X, N_Z, x[:N_X], P, x[X_NU:X_GAMMA], p[P_H:P_R], p[P_R:P_SCORE],
        p[P_SCORE:], x[X_GAMMA:X_NEXT], x[X_WORK:],
    )  # fmt: skip
    for i in range(N_X):
        y[i] = x[i]


@pytest.mark.parametrize("score", [gaussian_score(), PPoint(0.05).score()])
def test_bit_equal(score: Array) -> None:
    rng = np.random.default_rng(6)
    F = np.eye(3) + 0.1 * rng.normal(size=(3, 3))
    F *= 0.97 / np.max(np.abs(np.linalg.eigvals(F)))
    H = rng.normal(size=(2, 3))
    parts = [F.ravel(), 0.01 * np.eye(3).ravel(), H.ravel(), np.array([1.0, 0.2, 0.2, 0.5]), score]
    block = Block(
        inputs=(Signal("z_1"), Signal("z_2")),
        outputs=tuple(Signal(name) for name in ("x_1", "x_2", "x_3", "nis")),
        step=estimate,
        parameters=np.concatenate(parts),
        state=np.concatenate([np.zeros(X_WORK), np.zeros(update_work(N_X, N_Z))]),
    )
    assert len(score) == N_SCORE
    rows = assert_bit_equal(block, rng.standard_t(2.0, (2000, 2)))
    assert np.isfinite(rows).all()
    assert rows[:, 3].min() > 0.0
