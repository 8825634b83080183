"""(4) as difference equations, bumpless retuning, limits without windup."""

import numpy as np
import pytest

from controllers.core.errors import ControllerError
from controllers.papers.serkies2013.two_mass import two_mass_gains
from controllers.papers.serkies2013.two_mass_controller import TwoMassController
from controllers.state_space.state_feedback import StateController
from tests.controllers.compiled import run

T_S = 5e-4
DRIVE = {
    "resonant_frequency": 40.0,
    "damping": 0.7,
    "motor_time_constant": 0.203,
    "shaft_time_constant": 1.2e-3,
}


def test_fixed_gains_against_the_written_equation():
    rng = np.random.default_rng(1)
    u = rng.normal(size=(200, 5))
    k_i, k = 3.0, np.array([0.5, -1.5, 2.0])
    rows = run(StateController(k_i=k_i, k=tuple(k)).block(T_S), u)
    error = u[:, 0] - u[:, 1]
    integral = np.concatenate([[0.0], np.cumsum(0.5 * (error[1:] + error[:-1])) * T_S])
    expected = k @ u[0, 2:] + k_i * integral - u[:, 2:] @ k
    assert rows[:, 0] == pytest.approx(expected, abs=1e-12)
    assert rows[0, 0] == 0.0


def test_gains_in_force_are_those_of_the_time_constant():
    inertia = np.array([0.05, 0.2, 0.6])
    u = np.column_stack([np.zeros((3, 5)), inertia])
    rows = run(TwoMassController(**DRIVE).block(T_S), u)
    for row, T_2 in zip(rows, inertia, strict=True):
        k = np.empty(4)
        two_mass_gains(np.array([0.203, 1.2e-3, 40.0, 0.7]), np.array([T_2]), k)
        assert np.array_equal(row[5:], k)


@pytest.mark.parametrize("bumpless", [True, False])
def test_retuning_moves_the_control_only_where_it_may(bumpless):
    """At rest of the loop (no error, constant state) only T_2 changes, at the fifth sample."""
    u = np.tile([1.0, 1.0, 1.0, 0.3, 1.0, 0.2], (10, 1))
    u[5:, 5] = 0.4
    controller = TwoMassController(**DRIVE, bumpless=bumpless)
    rows = run(controller.block(T_S), u)
    jump = rows[5, 0] - rows[4, 0]
    gained = (rows[4, 6:] - rows[5, 6:]) @ u[0, 2:5]
    assert abs(gained) > 1.0
    assert jump == pytest.approx(0.0 if bumpless else gained, abs=1e-12)


def test_at_its_limit_it_does_not_wind_up():
    """A second of error at the limit; when the error turns, the control leaves it at once."""
    u = np.zeros((2100, 3))
    u[:2000, 0], u[2000:, 0] = 1.0, -1.0
    rows = run(StateController(k_i=10.0, k=(0.0,), u_min=-3.0, u_max=3.0).block(T_S), u)
    assert rows[1999, 0] == pytest.approx(3.0, abs=10.0 * T_S)
    assert rows[:, 0].max() <= 3.0
    assert rows[2005, 0] < rows[1999, 0]
    assert rows[2099, 0] == pytest.approx(rows[2000, 0] - 99 * 10.0 * T_S, abs=1e-9)


def test_saturation_is_reported():
    u = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -9.0], [0.0, 0.0, 9.0]])
    rows = run(StateController(k_i=1.0, k=(1.0,), u_min=-3.0, u_max=3.0).block(T_S), u)
    assert list(rows[:, 0]) == [0.0, 3.0, -3.0]
    assert list(rows[:, 4]) == [0.0, 1.0, -1.0]


def test_faults():
    with pytest.raises(ControllerError, match="at least one"):
        StateController(k_i=1.0, k=())
    with pytest.raises(ControllerError, match="damping"):
        TwoMassController(**{**DRIVE, "damping": 0.0})
    with pytest.raises(ControllerError, match="u_min"):
        TwoMassController(**DRIVE, u_min=1.0, u_max=-1.0).block(T_S)
