"""Observability of the servo from its two sensors, by rank and by what cannot be seen."""

import numpy as np
import pytest

from controllers.core.block import Array
from controllers.papers.raheem2013.servo_model import ServoParameters, servo_jacobian

NOMINAL = np.array([0.01, 0.01, 1e6, 1e-6])
TIME = 2e-3  # s, that of the oscillation; makes the rows of the observability matrix comparable
STATES = [
    np.array([0.01, 0.02, 5e5, 4.5e-6]),
    np.array([0.0, 0.0, 0.0, 0.0]),
    np.array([0.01, 0.0, 5e5, -1e-8]),
    np.array([-0.05, -0.1, -9e6, -4.5e-6]),
]
SPEED, POSITION = np.eye(4)[1], np.eye(4)[0]


def observability(C: Array, x: Array, **changed: float) -> Array:
    """Rows C·Aⁱ, i = 0 … 3, in nominal units."""
    A = np.zeros(16)
    servo_jacobian(ServoParameters(**changed).coefficients(), x, np.zeros(1), A)
    scaled = TIME * A.reshape(4, 4) * NOMINAL / NOMINAL[:, None]
    rows = [C]
    for _ in range(3):
        rows.append(rows[-1] @ scaled)
    return np.array([row / np.linalg.norm(row) for row in rows])


def smallest(matrix: Array) -> float:
    values = np.linalg.svd(matrix, compute_uv=False)
    return float(values[-1] / values[0])


@pytest.mark.parametrize("x", STATES)
def test_both_sensors_see_the_whole_state(x: Array) -> None:
    for C in (SPEED, POSITION):
        assert np.linalg.matrix_rank(observability(C, x), tol=1e-9) == 4


@pytest.mark.parametrize("x", STATES)
def test_speed_sees_the_state_worse_than_position(x: Array) -> None:
    """By the smallest singular value over the largest: 12 to 25 times worse."""
    ratio = smallest(observability(POSITION, x)) / smallest(observability(SPEED, x))
    assert 10.0 < ratio < 30.0


def test_the_slow_mode_shows_in_the_speed_by_its_pole_alone() -> None:
    """Position and load pressure fall together at λ = −0.3/s: the speed is λ times the position."""
    A = np.zeros(16)
    servo_jacobian(ServoParameters().coefficients(), STATES[1], np.zeros(1), A)
    values, vectors = np.linalg.eig(A.reshape(4, 4))
    slow = int(np.argmin(np.abs(values)))
    shown = (vectors[1, slow] / vectors[0, slow]).real
    q = ServoParameters()
    assert shown == pytest.approx(-q.spring_stiffness * q.leakage / q.piston_area**2, rel=5e-3)


@pytest.mark.parametrize("missing", ["leakage", "spring_stiffness"])
def test_speed_sees_the_position_only_through_spring_and_leakage(missing: str) -> None:
    """At a closed valve; an open one leaks through its orifice."""
    blind = observability(SPEED, STATES[1], **{missing: 0.0})
    assert np.linalg.matrix_rank(blind, tol=1e-9) == 3
    q = ServoParameters(**{missing: 0.0})
    unseen = np.array([q.piston_area, 0.0, q.spring_stiffness, 0.0]) / NOMINAL
    assert np.max(np.abs(blind @ unseen)) < 1e-12 * np.linalg.norm(unseen)
    assert np.linalg.matrix_rank(observability(POSITION, STATES[1], leakage=0.0), tol=1e-9) == 4


def test_without_valve_flow_the_spool_is_unseen() -> None:
    """P_L = P_s at an open valve: √ is zero, and so is the flow."""
    x = np.array([0.0, 0.0, 10342500.0, 4.5e-6])
    width = {"spool_sign_width": 1e-12, "orifice_root_width": 1.0}
    blind = observability(POSITION, x, **width)
    assert smallest(blind) < 1e-6 * smallest(observability(POSITION, STATES[0], **width))
