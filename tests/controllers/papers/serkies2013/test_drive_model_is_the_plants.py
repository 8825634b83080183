"""What controllers believe of the drive is what the plant's equations say."""

import numpy as np
import pytest

from controllers.papers.serkies2013.two_mass import (
    TRANSITION_WORK,
    drive_model,
    two_mass_transition,
)
from fmus.linearization import linearize
from fmus.two_mass_drive.model import NOMINAL, plant

ORDER = ("speed_1", "speed_2", "elastic_torque")


@pytest.mark.parametrize("T_2", [0.1, 0.203, 0.406])
def test_matrices(T_2):
    model = linearize(plant, np.zeros(5), np.array([0.0, 0.0, T_2]))
    at = [[s.name for s in plant.states].index(name) for name in ORDER]
    torque = [s.name for s in plant.states].index("torque_loop")
    A, B = drive_model(NOMINAL, T_2, 1.2e-3)
    assert model.A[np.ix_(at, at)] == pytest.approx(A[:3, :3], rel=1e-12)
    assert model.A[at, torque] == pytest.approx(B[:3, 0], rel=1e-12)
    assert model.B[at, 1] == pytest.approx(A[:3, 3], rel=1e-12)
    assert not A[3].any() and B[3, 0] == 0.0


def test_the_jacobian_is_the_derivative_of_the_transition():
    p, s, u = np.array([NOMINAL, 1.2e-3, 5e-4]), np.array([0.203]), np.array([0.7])
    x, F, work = np.array([0.3, 0.2, 0.5, 0.1]), np.empty(16), np.empty(TRANSITION_WORK)

    def following(x):
        y = np.empty(4)
        two_mass_transition(p, s, x, u, y, F, work)
        return y

    columns = [(following(x + 0.5 * e) - following(x - 0.5 * e)) for e in np.eye(4)]
    following(x)
    assert np.column_stack(columns) == pytest.approx(F.reshape(4, 4), abs=1e-13)
