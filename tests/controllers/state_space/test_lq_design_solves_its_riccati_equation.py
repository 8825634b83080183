"""LQ design: residual, poles, optimality, and what it refuses."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from controllers.core.errors import ControllerError
from controllers.state_space.lq import continuous_lq, discrete_lq

SEED = 11


def systems():
    """Random systems of 1 to 6 states, unstable ones among them."""
    rng = np.random.default_rng(SEED)
    for n in range(1, 7):
        for r in range(1, 3):
            root = rng.normal(size=(n, n))
            yield rng.normal(size=(n, n)), rng.normal(size=(n, r)), root @ root.T, np.eye(r)


@pytest.mark.parametrize("design", [continuous_lq, discrete_lq])
def test_residual_is_rounding_and_the_loop_is_stable(design):
    for A, B, Q, R in systems():
        found = design(A, B, Q, R)
        size = max(1.0, float(np.abs(found.P).max()) ** 2)
        assert found.residual < 1e-10 * size
        assert np.array_equal(found.P, found.P.T)
        assert np.linalg.eigvalsh(found.P)[0] > -1e-10 * size
        expected = np.sort_complex(np.linalg.eigvals(A - B @ found.K))
        assert np.abs(found.poles - expected).max() < 1e-12
        limit = found.poles.real.max() if design is continuous_lq else np.abs(found.poles).max() - 1
        assert limit < 0.0


def test_double_integrator_has_the_gain_of_the_textbook():
    """Q = diag(1, 0), R = 1: K = (1, √2)."""
    found = continuous_lq(np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]),
                          np.diag([1.0, 0.0]), np.eye(1))  # fmt: skip
    assert np.abs(found.K - [[1.0, np.sqrt(2.0)]]).max() < 1e-14


def test_the_cost_of_a_run_is_half_x_P_x():
    A, B, Q, R = list(systems())[5]
    found = continuous_lq(A, B, Q, R)

    def loop(t, z):
        x = z[:-1]
        u = -found.K @ x
        return [*(A @ x + B @ u), 0.5 * (x @ Q @ x + u @ R @ u)]

    x = np.arange(1.0, len(A) + 1)
    run = solve_ivp(loop, (0.0, 400.0), [*x, 0.0], method="DOP853", rtol=1e-12, atol=1e-13)
    assert run.y[-1, -1] == pytest.approx(0.5 * x @ found.P @ x, rel=1e-9)


def test_a_decaying_state_out_of_reach_is_allowed_and_a_growing_one_refused():
    B, Q, R = np.array([[1.0], [0.0]]), np.eye(2), np.eye(1)
    assert continuous_lq(np.diag([1.0, -0.1]), B, Q, R).poles.real.max() == pytest.approx(-0.1)
    with pytest.raises(ControllerError, match="continuous_lq"):
        continuous_lq(np.diag([1.0, 0.1]), B, Q, R)
    with pytest.raises(ControllerError, match="discrete_lq"):
        discrete_lq(np.diag([0.5, 1.1]), B, Q, R)


@pytest.mark.parametrize(
    ("name", "value"),
    [("Q", np.diag([1.0, -1.0])), ("R", -np.eye(1)), ("Q", np.eye(3)),
     ("Q", np.array([[1.0, 0.5], [0.0, 1.0]])), ("A", np.full((2, 2), np.nan))],
)  # fmt: skip
def test_weights_and_shapes_that_cannot_be_meant_are_refused(name, value):
    given = {"A": np.eye(2), "B": np.eye(2)[:, :1], "Q": np.eye(2), "R": np.eye(1), name: value}
    with pytest.raises(ControllerError, match=f"continuous_lq: {name}"):
        continuous_lq(**given)
