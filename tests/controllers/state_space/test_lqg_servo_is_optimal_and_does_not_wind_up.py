"""The LQG servo: its gains solve both Riccati equations, and a disturbance leaves no error."""

import numpy as np
import pytest
from scipy import linalg

from controllers.core.errors import ControllerError
from controllers.state_space.lqg_servo import LQGServo

T, SLOPE, LAG = 0.01, 1e5, 0.03
SETTINGS = {
    "slope": SLOPE, "lag": LAG, "output_noise": 100.0, "disturbance_noise": 3e3,
    "measurement_noise": 60.0, "error_scale": 9e3,
}  # fmt: skip
SERVO = LQGServo(**SETTINGS, u_min=-1.0, u_max=1.0)


def sampled(steps: int = 2000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Φ, Γ and the covariance of the noise over a sample, by small steps."""
    A = np.array([[0.0, SLOPE, 1.0], [0.0, -1.0 / LAG, 0.0], [0.0, 0.0, 0.0]])
    B = np.array([0.0, 1.0 / LAG, 0.0])
    noise, h = np.diag([100.0**2, 0.0, 3e3**2]), T / steps
    part = linalg.expm(A * h)
    Phi, Gamma, Q = np.eye(3), np.zeros(3), np.zeros((3, 3))
    for _ in range(steps):
        Gamma = Gamma + h * 0.5 * (Phi + part @ Phi) @ B
        Q = Q + h * 0.5 * (Phi @ noise @ Phi.T + part @ Phi @ noise @ Phi.T @ part.T)
        Phi = part @ Phi
    return Phi, Gamma, Q


def test_the_gains_are_where_both_recursions_end() -> None:
    Phi, Gamma, Q = sampled()
    found = SERVO.design(T)
    np.testing.assert_allclose(found.Phi, Phi, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.Gamma, Gamma, rtol=1e-5)
    P, L = np.diag([1e4, 1.0, 1e6]), np.zeros(3)
    S, K = np.zeros((2, 2)), np.zeros(2)
    A, B = Phi[:2, :2], Gamma[:2]
    for _ in range(3000):
        P = Phi @ P @ Phi.T + Q
        L = P[:, 0] / (P[0, 0] + 60.0**2)
        P = P - np.outer(L, P[0])
        K = B @ S @ A / (1.0 + B @ S @ B)
        S = np.diag([1.0 / 9e3**2, 0.0]) + A.T @ S @ (A - np.outer(B, K))
    np.testing.assert_allclose(found.L, L, rtol=1e-4, atol=1e-9)
    np.testing.assert_allclose(found.K, K, rtol=1e-4)


def run(reference: float, disturbance: float, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Output and control over time on the process itself, sampled by another route."""
    block = SERVO.block(T)
    Phi, Gamma, _ = sampled()
    process, state, y = np.array([0.0, 0.0, disturbance]), block.state.copy(), np.zeros(5)
    outputs, controls = [], []
    for _ in range(round(seconds / T)):
        block.step(block.parameters, state, np.array([reference, process[0]]), y)
        outputs.append(process[0])
        controls.append(y[0])
        process = Phi @ process + Gamma * y[0]
    return np.array(outputs), np.array(controls)


@pytest.mark.parametrize("disturbance", [0.0, 2e4, -5e4])
def test_a_constant_disturbance_leaves_no_error(disturbance: float) -> None:
    outputs, controls = run(2000.0, disturbance, 4.0)
    np.testing.assert_allclose(outputs[-50:], 2000.0, rtol=1e-3)
    assert controls[-1] == pytest.approx(-disturbance / SLOPE, abs=1e-4)


def test_a_limited_control_winds_nothing_up() -> None:
    """1 MN takes ten seconds at the limit; then the output does not go beyond by 1 %."""
    outputs, controls = run(1e6, 0.0, 14.0)
    assert np.mean(controls == 1.0) > 0.6
    assert outputs.max() < 1.01e6 and outputs[-1] == pytest.approx(1e6, rel=1e-3)


def test_the_linear_system_is_the_block() -> None:
    A, B, C, D = SERVO.loop(T)
    block, x = SERVO.block(T), np.zeros(3)
    state, y = block.state.copy(), np.zeros(5)
    for measured in np.random.default_rng(1).normal(0.0, 100.0, 50):
        block.step(block.parameters, state, np.array([0.0, measured]), y)
        assert y[0] == pytest.approx(float(C @ x - D * measured), rel=1e-9, abs=1e-12)
        x = A @ x - B * measured


def test_values_that_cannot_be_meant() -> None:
    with pytest.raises(ControllerError, match=r"LQGServo\.lag"):
        LQGServo(**{**SETTINGS, "lag": 0.0})
    with pytest.raises(ControllerError, match="u_min below"):
        LQGServo(**SETTINGS, u_min=1.0, u_max=0.0)
