"""From one instant to the next: orders of convergence, and F and Γ as exact derivatives."""

import numpy as np
import pytest
from scipy.linalg import expm

from controllers.core.bind import bind
from controllers.core.block import Array, Signal
from controllers.kalman.linear_model import linear_jacobian, linear_model, linear_noise, linear_rate
from controllers.kalman.transition import (
    apply_map,
    held_noise,
    integrate,
    model_slope,
    reset_derivatives,
    transition_size,
    transition_work,
)
from controllers.papers.raheem2013.servo_model import (
    ServoParameters,
    servo_jacobian,
    servo_noise,
    servo_rate,
)

servo = bind(
    integrate,
    model_slope=bind(
        model_slope, model_rate=servo_rate, model_jacobian=servo_jacobian, model_noise=servo_noise
    ),
)
linear_functions = {
    "model_rate": linear_rate,
    "model_jacobian": linear_jacobian,
    "model_noise": linear_noise,
}
linear = bind(integrate, model_slope=bind(model_slope, **linear_functions))
START = np.array([0.01, 0.01, 5e5, 2e-6])
NOMINAL = np.array([0.01, 0.01, 1e6, 1e-6])
CURRENT = np.array([1e-3])
p = ServoParameters().coefficients()


def moved(kernel, n, n_w, stages, substeps, T, p, u, x):  # type: ignore[no-untyped-def]
    """x⁺ (n,), F (n, n), Γ (n, n_w)."""
    X = np.zeros(transition_size(n, n_w))
    reset_derivatives(n, n_w, X)
    X[:n] = x
    kernel(n, n_w, stages, substeps, T, p, u, X, np.zeros(transition_work(n, n_w)))
    return X[:n], X[n : n + n * n].reshape(n, n), X[n + n * n :].reshape(n, n_w)


def servo_moved(stages: int, substeps: int, x: Array, T: float = 1e-3):  # type: ignore[no-untyped-def]
    return moved(servo, 4, 2, stages, substeps, T, p, CURRENT, x)


@pytest.mark.parametrize(("stages", "order"), [(1, 1), (4, 4)])
def test_order_of_convergence(stages: int, order: int) -> None:
    exact = servo_moved(4, 400, START)
    counts = (100, 200) if stages == 1 else (10, 20)
    for part in range(3):
        errors = [servo_moved(stages, c, START)[part] - exact[part] for c in counts]
        nominal = NOMINAL if part == 0 else np.outer(NOMINAL, np.ones(errors[0].shape[1]))
        ratio = np.max(np.abs(errors[0]) / nominal) / np.max(np.abs(errors[1]) / nominal)
        assert ratio == pytest.approx(2**order, rel=0.2), part


@pytest.mark.parametrize(("stages", "substeps"), [(1, 1), (1, 5), (4, 1), (4, 3)])
def test_F_is_the_derivative_of_the_numerical_step(stages: int, substeps: int) -> None:
    _, F, _ = servo_moved(stages, substeps, START)
    for i in range(4):
        h = 1e-3 * NOMINAL[i] * np.eye(4)[i]
        ahead, back = (servo_moved(stages, substeps, START + s * h)[0] for s in (1, -1))
        slope = (ahead - back) / (2e-3 * NOMINAL[i])
        scale = np.abs(F * NOMINAL).max(axis=1) / NOMINAL[i]
        assert np.all(np.abs(slope - F[:, i]) < 1e-6 * scale)


def linear_case(seed: int):  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(seed)
    A, B, G = rng.normal(size=(3, 3)), rng.normal(size=(3, 2)), rng.normal(size=(3, 1))
    counts = {"x": 3, "u": 2, "w": 1}
    names = [tuple(Signal(f"{kind}{i}") for i in range(n)) for kind, n in counts.items()]
    return A, B, G, linear_model(*names, A, B, G).parameters, rng.normal(size=3), rng.normal(size=2)


def test_a_linear_model_moves_as_the_matrix_exponential() -> None:
    A, B, G, parameters, x, u = linear_case(1)
    T = 0.3
    block = np.zeros((6, 6))
    block[:3, :3], block[:3, 3:5], block[:3, 5:] = A * T, B * T, G * T
    whole = expm(block)
    got, F, Gamma = moved(linear, 3, 1, 4, 60, T, parameters, u, x)
    np.testing.assert_allclose(got, whole[:3, :3] @ x + whole[:3, 3:5] @ u, rtol=1e-8)
    np.testing.assert_allclose(F, whole[:3, :3], atol=1e-8)
    np.testing.assert_allclose(Gamma, whole[:3, 5:], atol=1e-8)


def test_a_map_is_applied_as_it_is() -> None:
    A, B, G, parameters, x, u = linear_case(2)
    got, F, Gamma = moved(bind(apply_map, **linear_functions), 3, 1, 0, 1, 1.0, parameters, u, x)
    np.testing.assert_allclose(got, A @ x + B @ u, rtol=1e-14)
    assert np.array_equal(F, A)
    assert np.array_equal(Gamma, G)


def test_noise_held_over_the_step_has_its_covariance() -> None:
    _, _, Gamma = servo_moved(4, 1, START)
    q, extra = np.array([1e-8, 400.0]), np.array([1e-12, 0.0, 4.0, 0.0])
    X, Q = np.zeros(transition_size(4, 2)), np.zeros(16)
    X[20:] = Gamma.ravel()
    held_noise(4, 2, q, extra, X, Q)
    expected = Gamma @ np.diag(q) @ Gamma.T + np.diag(extra)
    np.testing.assert_allclose(Q.reshape(4, 4), expected, rtol=1e-13, atol=0.0)
