"""The adapted gain falls with every level of noise, and with it what noise does to the torque."""

from pathlib import Path

import numpy as np

from harness.experiment.experiment import Experiment

FIGURE_7 = Path(__file__).parents[2] / "experiments/serkies2013/figure_7.toml"
LEVELS = (0.0003, 0.0006, 0.001, 0.002, 0.003, 0.006, 0.012)
SEED = 7


def uniform(size):
    return [{"kind": "noise", "signal": {"kind": "uniform", "low": -size, "high": size}}]


def steady(level, variant):
    """Mean gain factor, mean gain for the motor speed, ripple of the torque at constant speed."""
    wires = {
        "kalman.motor_speed": {"imperfections": uniform(level)},
        "kalman.electromagnetic_torque": {"imperfections": uniform(level / 3)},
    }
    settings = {"stop_time": 1.0, "connections": wires, "metrics": {}, "plots": {}}
    result = Experiment.load(FIGURE_7, settings).bench(variant, seed=SEED).run()
    rows = (result.time > 0.55) & (result.time < 0.79)
    torque = result["drive.electromagnetic_torque"][rows]
    factor, gain = (
        result[f"kalman.{name}"][rows].mean()
        for name in ("gain_factor", "gain_estimated_motor_speed")
    )
    return factor, gain, torque.std()


def test_every_level_of_noise_lowers_the_gain():
    factors, gains, _ = np.array([steady(level, "adaptive") for level in LEVELS]).T
    assert np.all(np.diff(factors) < 0.0), factors
    assert np.all(np.diff(gains) < 0.0), gains
    assert factors[0] > 0.9 and factors[-1] < 0.15


def test_adaptation_removes_a_third_of_the_ripple_under_strong_noise():
    for level in (0.003, 0.006):
        assert steady(level, "adaptive")[2] < 0.65 * steady(level, "fixed")[2]
