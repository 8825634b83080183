"""The controllers that stand beside those of the lead paper: by rule, and with their margins."""

from pathlib import Path

import numpy as np
import pytest

from controllers.pid.design import simc_integrating
from controllers.state_space.lqg_servo import LQGServo
from harness.experiment.experiment import Experiment
from tests.experiments.test_gains_follow_their_rule import DELAY, slope

FOLDER = Path(__file__).parents[2] / "experiments/ahn2009"
T, LAG = 0.01, 0.006  # s; the lag is that of the drive's speed loop
W = np.logspace(-1.0, np.log10(0.999 * np.pi / T), 20_000)  # rad/s


def parameters(variant: str, file: str = "base/loop.toml") -> dict[str, float]:
    return Experiment.load(FOLDER / file).variant_spec(variant).components["controller"].parameters


def controller(variant: str) -> np.ndarray:
    """The frequency response from the error to the command."""
    p = parameters(variant)
    if variant != "lqg":
        s = 1j * W
        return p["kp"] + p["ki"] / s + p["kd"] * s / (1.0 + p["derivative_filter"] * s)
    A, B, C, D = LQGServo(**p).loop(T)
    return np.array([C @ np.linalg.solve(z * np.eye(3) - A, B) + D for z in np.exp(1j * W * T)])


def margins(variant: str) -> tuple[float, float, float]:
    """Gain margin, phase margin in degrees, and largest sensitivity on the process of the rule."""
    loop = controller(variant) * slope() / (1j * W) / (1.0 + LAG * 1j * W) * np.exp(-DELAY * 1j * W)
    gain, phase = np.abs(loop), np.unwrap(np.angle(loop))
    crossover = np.flatnonzero((gain[:-1] > 1.0) & (gain[1:] <= 1.0))[-1]
    turned = np.flatnonzero((phase[:-1] > -np.pi) & (phase[1:] <= -np.pi))[-1]
    degrees = 180.0 + np.degrees(phase[crossover])
    return float(1.0 / gain[turned]), float(degrees), float(np.max(1.0 / np.abs(1.0 + loop)))


def test_the_tight_pid_is_the_rule_with_the_delay_as_closed_loop_time() -> None:
    rule, p = simc_integrating(slope(), DELAY), parameters("pid_simc")
    assert p["kp"] == pytest.approx(rule.kp, rel=0.01)
    assert p["ki"] == pytest.approx(rule.ki, rel=0.01)
    assert p["kd"] == pytest.approx(rule.kp * LAG, rel=0.01)


@pytest.mark.parametrize("variant", ["pid_simc", "lqg"])
def test_what_is_recommended_has_margins(variant: str) -> None:
    gain, degrees, sensitivity = margins(variant)
    assert gain > 2.1 and degrees > 38.0 and sensitivity < 2.2


@pytest.mark.parametrize(
    ("variant", "stated"),
    [
        ("pid", (7.23, 66.0, 1.20)),
        ("pid_simc", (2.37, 46.0, 1.90)),
        ("pid_top", (1.81, 43.0, 2.47)),
        ("lqg", (2.19, 40.0, 2.09)),
    ],
)
def test_margins_are_those_that_the_page_states(
    variant: str, stated: tuple[float, float, float]
) -> None:
    np.testing.assert_allclose(margins(variant), stated, rtol=0.01)


@pytest.mark.parametrize("file", ["figure_7", "figure_11", "load"])
def test_the_pid_of_hindsight_is_a_point_of_its_grid(file: str) -> None:
    experiment = Experiment.load(FOLDER / f"{file}.toml")
    sweep, p = experiment.spec.sweep, parameters("pid_tuned", f"{file}.toml")
    assert sweep is not None and experiment.spec.study is not None
    for value, axis in ((p["kp"], sweep.x), (p["ki"], sweep.y)):
        assert min(abs(value / one - 1.0) for one in axis.values) < 1e-6
    last = experiment.spec.seed + experiment.spec.study.seeds
    assert sweep.seed is not None and not experiment.spec.seed <= sweep.seed < last


def test_the_matched_fuzzy_pid_has_the_integral_gain_of_the_pid_at_rest() -> None:
    assert parameters("fuzzy_matched")["ki"][1] == parameters("pid")["ki"]
