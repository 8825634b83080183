"""The PID gains of the lead paper are what their stated rule gives for the plant's parameters."""

import math
from pathlib import Path

import pytest

from controllers.pid.design import simc_integrating
from fmus.hybrid_actuator.model import plant
from harness.experiment.experiment import Experiment

LOOP = Path(__file__).parents[2] / "experiments/ahn2009/base/loop.toml"
RISE_TIME = 0.27  # s, Table 4
DELAY = 0.025  # s: half a sample, one sample, drive and sensor


def slope() -> float:
    """Force per second and unit of command, N/s: rated flow over piston area times stiffness."""
    p = {parameter.name: parameter.value for parameter in plant.parameters}
    flow = p["pump_displacement"] * p["rated_speed"] / (2.0 * math.pi)
    return flow / (math.pi / 4.0 * p["piston_diameter"] ** 2) * p["spring_stiffness"]


def test_the_slope_is_that_of_the_sanity_figures() -> None:
    assert slope() == pytest.approx(104e3, rel=0.01)


def test_pid_gains() -> None:
    rule = simc_integrating(slope(), DELAY, closed_loop_time=RISE_TIME / 2.2)
    given = Experiment.load(LOOP).spec.components["controller"].parameters
    assert given["kp"] == pytest.approx(rule.kp, rel=0.01)
    assert given["ki"] == pytest.approx(rule.ki, rel=0.01)
    assert given["kd"] == pytest.approx(rule.kp * 0.006, rel=0.01)


def test_fuzzy_ranges_go_from_a_quarter_to_four_times_the_gains() -> None:
    experiment = Experiment.load(LOOP)
    pid = experiment.spec.components["controller"].parameters
    fuzzy = experiment.variant_spec("fuzzy_pid").components["controller"].parameters
    top = experiment.variant_spec("pid_top").components["controller"].parameters
    for name in ("kp", "ki", "kd"):
        assert fuzzy[name] == pytest.approx([pid[name] / 4.0, pid[name] * 4.0])
        assert top[name] == pytest.approx(pid[name] * 4.0)
