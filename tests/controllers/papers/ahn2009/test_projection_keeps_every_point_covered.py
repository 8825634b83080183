"""What holds of θ after an update, however wild, and that the initial θ is left as it is."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.fuzzy.inference import infer
from controllers.papers.ahn2009.fuzzy_pid import FuzzyPID
from controllers.papers.ahn2009.tuned_fuzzy_pid import TunedFuzzyPID
from controllers.papers.ahn2009.tuner import project
from tests.controllers.compiled import run

FLOOR = GAP = 0.02
BASE = FuzzyPID(kp=(0, 1), ki=(0, 1), kd=(0, 1), error_range=1.0, error_rate_range=1.0)
SYSTEM = BASE.system("p")


def assert_meant(theta: np.ndarray) -> None:
    triangles, weights = theta[:30].reshape(2, 5, 3), theta[30:]
    centres, half_widths = triangles[:, :, 0], triangles[:, :, 1:]
    assert np.all((centres >= 0) & (centres <= 1))
    assert np.all(np.diff(centres) >= GAP - 1e-15)
    assert np.all(half_widths >= FLOOR)
    reach = half_widths[:, :-1, 1] + half_widths[:, 1:, 0]
    assert np.all(reach >= np.diff(centres) + FLOOR - 1e-14)
    assert np.all((weights >= 0) & (weights <= 1))


@settings(max_examples=200, deadline=None)
@given(
    theta=st.lists(st.floats(-3, 3), min_size=35, max_size=35).map(np.array),
    x=st.tuples(st.floats(0, 1), st.floats(0, 1)),
)
def test_any_vector_becomes_one_under_which_a_rule_fires(theta, x) -> None:
    project(theta, 5, 5, FLOOR, GAP)
    assert_meant(theta)
    again = theta.copy()
    project(again, 5, 5, FLOOR, GAP)
    np.testing.assert_allclose(again, theta, atol=1e-14)
    work = (np.zeros(10), np.zeros(25), np.zeros(5))
    out = np.full(1, np.nan)
    assert infer(SYSTEM.structure(), theta, np.array(x), *work, out) == 0
    assert 0.0 <= out[0] <= 1.0


def test_the_initial_vector_stays() -> None:
    theta = SYSTEM.theta()
    project(theta, 5, 5, FLOOR, GAP)
    assert theta.tobytes() == SYSTEM.theta().tobytes()


def test_after_every_update_of_a_violent_run() -> None:
    controller = TunedFuzzyPID(
        kp=(1e-4, 5e-4),
        ki=(0.0, 1e-3),
        kd=(0.0, 1e-5),
        error_range=2000.0,
        error_rate_range=2e5,
        sensitivity_bounds=(-1000.0, 1000.0),
        filter="ekf",
        r=1.0,
        q_centre=0.1,
        q_half_width=0.1,
        q_weight=0.1,
    )
    block = controller.block(0.01)
    noise = np.random.default_rng(3).normal(1500, 900, 120)
    rows = run(block, np.column_stack([np.full(120, 2000.0), noise]))
    at = [s.name for s in block.outputs].index("mf_p_a_1_1")
    for row in rows:
        for axis in range(3):
            assert_meant(row[at + 35 * axis : at + 35 * (axis + 1)])
        assert 1e-4 <= row[6] <= 5e-4
