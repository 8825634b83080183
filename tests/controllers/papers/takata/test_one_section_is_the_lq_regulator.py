"""Augmented choosing control is LQ control where there is one section; (6), (9) in general."""

import math

import numpy as np
import pytest

from controllers.core.errors import ControllerError
from controllers.papers.takata.augmented_choosing import AugmentedChoosing
from controllers.state_space.lq_regulator import LQRegulator
from tests.controllers.compiled import assert_bit_equal, run

INF = math.inf
MODEL = "controllers.papers.takata.machine_model:MachineParameters"
PAPER = {
    "model": MODEL, "points": ((0.0, 0.0), (1.51, 0.0)), "lower": ((-INF,), (0.6,)),
    "upper": ((0.6,), (INF,)), "sharpness": 8.0, "separative": ((1.0, 0.0),),
    "Q": (1.0, 1.0, 1.0), "R": (1.0,), "sigma": 0.1,
}  # fmt: skip
ONE = {**PAPER, "points": ((0.0, 0.0),), "lower": ((-INF,),), "upper": ((INF,),)}


def states(count=400):
    return np.random.default_rng(4).uniform((-3, -10), (3, 10), (count, 2))


def test_one_section_is_the_lq_regulator():
    regulator = LQRegulator(model=MODEL, Q=(1.0, 1.0), R=(1.0,))
    one = run(AugmentedChoosing(**ONE).block(0.01), states())
    assert np.abs(one[:, 0] - run(regulator.block(0.01), states())[:, 0]).max() < 1e-12


def test_sections_that_are_all_alike_are_one_section():
    alike = {**PAPER, "lower": ((-INF,), (-0.1,)), "upper": ((-0.1,), (INF,))}
    alike["points"] = ((0.0, 0.0), (0.0, 0.0))
    with pytest.raises(ControllerError, match="section 0"):
        AugmentedChoosing(**alike)
    alike |= {"lower": ((-INF,), (0.0,)), "upper": ((0.0,), (INF,))}
    two = run(AugmentedChoosing(**alike).block(0.01), states())
    assert (
        np.abs(two[:, 0] - run(AugmentedChoosing(**ONE).block(0.01), states())[:, 0]).max() < 1e-12
    )


def test_riccati_residuals_of_the_paper():
    designs = [*AugmentedChoosing(**PAPER).designs]
    designs.append(LQRegulator(model=MODEL, Q=(1.0, 1.0), R=(1.0,)).design)
    for design in designs:
        assert design.residual < 1e-10
        assert design.poles.real.max() < 0.0
    # At rest P₁₂·B₂ of the 2 × 2 equation has a closed form: p² b² + 2 a p = 1 with k = b·p.
    a, b = -0.6 / 0.06, -0.8 / 0.06
    assert designs[0].K[0, 0] == pytest.approx(b * (a + math.sqrt(a * a + b * b)) / b**2, rel=1e-13)
    assert np.abs(designs[0].K[0, :2] - designs[2].K[0]).max() < 1e-13
    assert abs(designs[0].K[0, 2]) < 1e-13


def test_outputs_are_equations_4_6_and_9():
    controller = AugmentedChoosing(**PAPER)
    rows = run(controller.block(0.01), states())
    F = [design.K[0] for design in controller.designs]
    for k, (x, row) in enumerate(zip(states(), rows, strict=True)):
        X = np.array([*x, math.exp(-0.1 * 0.01 * k)])
        sections = [-f @ X for f in F]
        weights = controller.functions().weights(x[:1])
        assert row[1] == pytest.approx(X[2], rel=1e-12)
        assert row[2:4] == pytest.approx(weights, abs=1e-15)
        assert row[4:] == pytest.approx(sections, rel=1e-11, abs=1e-11)
        assert row[0] == pytest.approx(weights @ sections, rel=1e-11, abs=1e-11)


def test_compiled_equals_interpreted():
    assert_bit_equal(AugmentedChoosing(**PAPER, u_min=-5.0, u_max=5.0).block(0.01), states())


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"points": ((0.0, 0.0), (0.5, 0.0))}, "χ_1: expected a point in section 1"),
        ({"points": ((0.1, 0.0), (1.51, 0.0))}, "χ_0"),
        ({"Q": (1.0, 1.0)}, "3 diagonal elements"),
        ({"separative": ((1.0,),)}, "separative"),
        ({"model": "controllers.papers.takata.machine_model:Machine"}, "package.module:Class"),
        ({"model_parameters": {"rest_angle": 0.9276}}, "equilibrium"),
    ],
)
def test_what_cannot_be_meant_is_refused(changes, match):
    with pytest.raises(ControllerError, match=match):
        AugmentedChoosing(**{**PAPER, **changes})
