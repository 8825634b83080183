"""Euler's method multiplies each mode of the servo by 1 + λT: unstable above −2 Re λ/|λ|²."""

import numpy as np
import pytest

from controllers.papers.raheem2013.servo_estimator import ServoEstimator
from fmus.electro_hydraulic_servo.model import plant
from fmus.linearization import linearize
from tests.controllers.compiled import run

A = linearize(plant, np.zeros(4), np.zeros(3)).A
VALUES, RIGHT = np.linalg.eig(A)
PAIR = int(np.argmax(VALUES.imag))
POLE = VALUES[PAIR]
LEFT = np.linalg.inv(RIGHT)[PAIR]  # LEFT·x is the amplitude of the hydraulic mode
LIMIT = -2.0 * POLE.real / abs(POLE) ** 2
STEPS = 150


def amplitudes(T: float, discretisation: str) -> np.ndarray:
    """Amplitude of the mode over the steps, from 10 µm/s of it, in the linear range."""
    mode = RIGHT[:, PAIR].real
    start = tuple(float(v) for v in mode * 1e-5 / abs(mode[1]))
    servo = ServoEstimator(
        measured="none", sensor_std=1.0, current_std=0.0, force_std=0.0,
        initial=start, discretisation=discretisation,
    )  # fmt: skip
    return run(servo.block(T), np.zeros((STEPS, 1)))[:, :4] @ LEFT


def test_the_limit_is_that_of_the_readme() -> None:
    assert pytest.approx(0.456e-3, abs=1e-6) == LIMIT


@pytest.mark.parametrize("share", [0.5, 0.9, 1.1, 2.0])
def test_each_step_multiplies_the_mode_by_one_plus_pole_times_step(share: float) -> None:
    T = share * LIMIT
    found = amplitudes(T, "euler")
    expected = found[0] * (1.0 + POLE * T) ** np.arange(STEPS)
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    assert (abs(found[-1]) > abs(found[0])) == (share > 1.0)


@pytest.mark.parametrize("share", [0.5, 2.0, 8.0])
def test_the_accurate_prediction_decays_at_every_sample_time(share: float) -> None:
    """As e^(λT) does, to the accuracy of one Runge–Kutta step."""
    T = share * LIMIT
    found = amplitudes(T, "runge_kutta")
    assert abs(found[-1]) < abs(found[0])
    error = abs(POLE * T) ** 5 / 120
    assert abs(found[1] / found[0] - np.exp(POLE * T)) < 1.2 * error
