"""Controller, filter, estimator, encoder and maps: compiled and interpreted, bit for bit."""

import numpy as np
import pytest

from controllers.papers.serkies2013.fuzzy_maps import FuzzyInertiaTables, GainAdaptationCurve
from controllers.papers.serkies2013.inertia_estimator import FuzzyInertiaEstimator
from controllers.papers.serkies2013.two_mass_controller import TwoMassController
from controllers.papers.serkies2013.two_mass_kalman import TwoMassKalman
from controllers.signals.encoder import EncoderSpeed
from controllers.state_space.state_feedback import StateController
from tests.controllers.compiled import assert_bit_equal
from tests.controllers.papers.serkies2013.test_inertia_estimator_follows_its_equations import TABLES

T_S = 5e-4
DRIVE = {"motor_time_constant": 0.203, "shaft_time_constant": 1.2e-3}
CURVE = {"distances": (0.1, 1.0, 6.0, 30.0), "gains": (1.0, 0.4, 0.2, 0.08), "window": 20}
FILTER = {**DRIVE, "q": (1e-5, 1e-5, 1e-4, 5.0), "r": 3e-6, "input_delay": 2e-4}
CASES = {
    "state controller": StateController(k_i=2.0, k=(1.0, -0.5), u_min=-1.0, u_max=1.0),
    "drive controller": TwoMassController(
        **DRIVE, resonant_frequency=40.0, damping=0.7, u_min=-3.0, u_max=3.0
    ),
    "as printed": TwoMassController(**DRIVE, resonant_frequency=40.0, damping=0.7, as_printed=True),
    "classical filter": TwoMassKalman(**FILTER),
    "adaptive filter": TwoMassKalman(**FILTER, **CURVE, scaled_noise=True),
    "innovation distance": TwoMassKalman(
        **FILTER, **CURVE, distance="innovation", covariance="riccati"
    ),
    "inertia estimator": FuzzyInertiaEstimator(**TABLES),
    "encoder": EncoderSpeed(base_speed=150.0),
    "tables": FuzzyInertiaTables(**TABLES),
    "curve": GainAdaptationCurve(**CURVE),
}


@pytest.mark.parametrize("name", CASES)
def test_bit_equal(name):
    """Inputs about 0.3, positive where time constants and factors are meant."""
    block = CASES[name].block(T_S)
    rng = np.random.default_rng(11)
    inputs = 0.3 + 0.2 * rng.normal(size=(300, len(block.inputs)))
    for column, signal in enumerate(block.inputs):
        if signal.name in ("load_time_constant", "q_scale", "r_scale", "distance"):
            inputs[:, column] = np.abs(inputs[:, column]) + 0.02
    rows = assert_bit_equal(block, inputs)
    assert np.isfinite(rows).all()
    assert rows.std(axis=0).max() > 0.0


def test_a_filter_without_a_covariance_says_so_with_nan():
    block = TwoMassKalman(**{**FILTER, "r": 1e-300}, initial_variance=(0.0,) * 4).block(T_S)
    rows = assert_bit_equal(block, np.array([[np.nan, 0.1, 0.2], [0.1, 0.1, 0.2]]))
    assert np.isnan(rows[1, 0])
