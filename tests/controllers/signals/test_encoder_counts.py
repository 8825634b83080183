"""Speed from an encoder: exact for constant speed, within one count of a sample otherwise."""

import numpy as np
import pytest

from controllers.core.errors import ControllerError
from controllers.signals.encoder import EncoderSpeed
from tests.controllers.compiled import run

T_S, BASE = 5e-4, 150.0
COUNT = 2 * np.pi / 36_000


def test_without_quantisation_a_constant_speed_is_exact():
    angle = 0.7 * BASE * T_S * np.arange(100)
    speed = run(EncoderSpeed(base_speed=BASE).block(T_S), angle[:, None])[:, 0]
    assert speed[0] == 0.0
    assert speed[1:] == pytest.approx(0.7, rel=1e-12)


def test_with_quantisation_the_error_is_below_one_count_and_sums_to_nothing():
    angle = 0.123 * BASE * T_S * np.arange(5000)
    counted = COUNT * np.rint(angle / COUNT)
    speed = run(EncoderSpeed(base_speed=BASE).block(T_S), counted[:, None])[1:, 0]
    resolution = COUNT / (T_S * BASE)
    error = speed - 0.123
    assert np.abs(error).max() <= resolution
    assert np.abs(error).max() > 0.4 * resolution
    assert abs(error.sum()) <= resolution


def test_faults():
    with pytest.raises(ControllerError, match="base_speed"):
        EncoderSpeed(base_speed=0.0)
