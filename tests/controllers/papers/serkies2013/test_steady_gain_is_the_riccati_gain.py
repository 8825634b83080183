"""The filter's gain settles at that of scipy's discrete Riccati solution; adapted, at that of the
modified Riccati equation, which is stable for every factor."""

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from controllers.papers.serkies2013.two_mass import drive_model
from controllers.papers.serkies2013.two_mass_kalman import TwoMassKalman
from controllers.state_space.discretisation import held
from tests.controllers.compiled import _REBUILT, rebuild

T_1, T_C, T_S = 0.203, 1.2e-3, 5e-4
H = np.array([[1.0, 0.0, 0.0, 0.0]])
Q_GOOD, Q_BAD, R = (1e-5, 1e-5, 1e-4, 5.0), (1e-4, 1e-4, 1e-2, 200.0), 3e-6
STATES = ("motor_speed", "load_speed", "shaft_torque", "load_torque")
NAMES = [f"gain_estimated_{name}" for name in STATES]


def settled(T_2, **parameters):
    """Gain in force (4,), its factor and the variances after 20 s of samples."""
    block = TwoMassKalman(
        motor_time_constant=T_1, shaft_time_constant=T_C, r=R, **parameters
    ).block(T_S)
    names = [signal.name for signal in block.outputs]
    step = rebuild(block.step, _REBUILT)
    p, x, y = block.parameters.copy(), block.state.copy(), np.zeros(len(names))
    u = np.array([0.0, 0.0, T_2])
    for _ in range(40_000):
        step(p, x, u, y)
    found = dict(zip(names, y, strict=True))
    variances = [v for name, v in found.items() if name.startswith("variance")]
    return np.array([found[name] for name in NAMES]), found["gain_factor"], np.array(variances)


def drive(T_2):
    return held(*drive_model(T_1, T_2, T_C), T_S)[0]


@pytest.mark.parametrize("q", [Q_GOOD, Q_BAD])
@pytest.mark.parametrize("T_2", [0.1, 0.203, 0.406])
def test_classical_filter(T_2, q):
    P = solve_discrete_are(drive(T_2).T, H.T, np.diag(q) * T_S, [[R]])
    S = H @ P @ H.T + R
    K = (P @ H.T / S).ravel()
    after = np.diag(P - np.outer(K, H @ P))
    gain, factor, variances = settled(T_2, q=q)
    assert factor == 1.0
    assert gain == pytest.approx(K, rel=1e-9)
    assert variances == pytest.approx(after, rel=1e-8)


@pytest.mark.parametrize("g", [0.05, 0.2, 0.5, 1.5, 1.95])
def test_adapted_filter_solves_the_modified_riccati_equation_and_is_stable(g):
    constant = {"distances": (0.0, 1.0), "gains": (g, g), "window": 1}
    gain, factor, _ = settled(0.203, q=Q_BAD, **constant)
    assert factor == g
    F, Q = drive(0.203), np.diag(Q_BAD) * T_S
    P = np.eye(4) * 1e-4
    for _ in range(40_000):
        K = P @ H.T / (H @ P @ H.T + R)
        P = F @ (P - (2 * g - g * g) * K @ H @ P) @ F.T + Q
    K = P @ H.T / (H @ P @ H.T + R)
    assert gain == pytest.approx(g * K.ravel(), rel=1e-8)
    assert np.abs(np.linalg.eigvals(F @ (np.eye(4) - g * K @ H))).max() < 1.0


def test_a_factor_outside_of_the_covariance_loses_stability_below_a_half():
    """Where (10) leaves P to K: the gain margin of the Kalman filter is all that g has."""
    constant = {"distances": (0.0, 1.0), "window": 1, "covariance": "riccati"}
    F = drive(0.203)
    radius = {}
    for g in (0.1, 0.2, 0.3, 0.5, 0.7, 1.0):
        gain, _, _ = settled(0.203, q=Q_BAD, gains=(g, g), **constant)
        radius[g] = np.abs(np.linalg.eigvals(F @ (np.eye(4) - np.outer(gain, H)))).max()
    assert all(radius[g] < 1.0 for g in (0.5, 0.7, 1.0))
    assert all(radius[g] > 1.0 for g in (0.1, 0.2, 0.3))
