"""(11) and (12): the integral with its dead zones and latch, the tables, and which way it goes."""

import numpy as np
import pytest

from controllers.core.errors import ControllerError
from controllers.papers.serkies2013.inertia_estimator import (
    OUTPUT_NAMES,
    FuzzyInertiaEstimator,
    dead_zone,
)
from tests.controllers.compiled import run

T_S = 5e-4
T_2 = ((0.6,) * 3, (0.2,) * 3, (0.05,) * 3)
K_T = ((20.0, 100.0, 20.0),) * 3
TABLES = {
    "er_centres": (-1.0, 0.0, 1.0),
    "speed_centres": (-1.0, 0.0, 1.0),
    "time_constants": T_2,
    "k_t": K_T,
    "q_scale": ((0.5,) * 3, (1.0,) * 3, (2.0,) * 3),
    "r_scale": ((1.0, 2.0, 1.0),) * 3,
}


def outputs(estimator, u):
    return dict(zip(OUTPUT_NAMES, run(estimator.block(T_S), np.asarray(u, float)).T, strict=True))


def transient(torque, direction=1.0, rows=400):
    """Standing at ±0.5 for 50 samples, then 0.2 behind the reference, load torque off by
    `torque` in the direction of the acceleration."""
    u = np.tile([0.5 * direction, 0.5 * direction, 0.1], (rows, 1))
    u[50:, 1] = 0.3 * direction
    u[50:, 2] = 0.1 + torque * direction
    return u


def test_outputs_are_named_in_their_order():
    block = FuzzyInertiaEstimator(**TABLES).block(T_S)
    assert tuple(signal.name for signal in block.outputs) == OUTPUT_NAMES


def test_18_rules_9_for_each_pair_of_outputs():
    rules = FuzzyInertiaEstimator(**TABLES).system().rules
    assert len(rules) == 18
    assert sum(rule.consequents[0] >= 0 and rule.consequents[1] >= 0 for rule in rules) == 9
    assert sum(rule.consequents[2] >= 0 and rule.consequents[3] >= 0 for rule in rules) == 9


@pytest.mark.parametrize("er", [-1.0, -0.7, 0.0, 0.25, 1.0])
@pytest.mark.parametrize("speed", [-1.0, -0.2, 0.0, 0.6, 1.0])
def test_the_surface_interpolates_its_table(er, speed):
    found = FuzzyInertiaEstimator(**TABLES).system().evaluate(er, speed)
    time_constant = np.interp(er, [-1.0, 0.0, 1.0], [0.6, 0.2, 0.05])
    k_t = np.interp(abs(speed), [0.0, 1.0], [100.0, 20.0])
    q = np.interp(er, [-1.0, 0.0, 1.0], [0.5, 1.0, 2.0])
    r = np.interp(abs(speed), [0.0, 1.0], [2.0, 1.0])
    assert found == pytest.approx([time_constant, k_t, q, r], rel=1e-14)


def test_the_integral_is_that_of_the_dead_zoned_product():
    zones = {"torque_dead_zone": 0.05, "speed_dead_zone": 0.02, "speed_dead_zone_share": 0.1}
    y = outputs(FuzzyInertiaEstimator(**TABLES, **zones), transient(0.15, rows=200))
    # ω_ref = 0.5: k_T = 60; dead zones 0.05 of both; latched 0.1 − 0.25 = −0.15.
    rate = -(0.15 - 0.05) * (0.2 - 0.05) * 60.0
    assert np.all(y["er"][:50] == 0.0)
    assert np.diff(y["er"][49:]) == pytest.approx(T_S * rate, rel=1e-9)
    assert y["latched_load_torque"] == pytest.approx(0.1)
    assert np.array_equal(y["active"], np.arange(200) >= 50)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize(("torque", "heavier"), [(0.4, True), (-0.4, False)])
def test_missing_torque_in_acceleration_means_a_heavier_load(torque, heavier, direction):
    end = outputs(FuzzyInertiaEstimator(**TABLES), transient(torque, direction))
    last = end["load_time_constant"][-1]
    assert last > 0.21 if heavier else last < 0.19


def test_a_load_step_at_constant_speed_teaches_nothing():
    u = np.tile([1.0, 1.0, 0.0], (2000, 1))
    u[500:, 2], u[500:600, 1] = 0.8, 0.93  # within a tenth of ω_ref
    y = outputs(FuzzyInertiaEstimator(**TABLES), u)
    assert np.all(y["er"] == 0.0)
    assert y["latched_load_torque"][-1] == pytest.approx(0.8, abs=1e-5)


def test_the_integral_stays_on_its_range():
    y = outputs(FuzzyInertiaEstimator(**TABLES), transient(3.0, rows=3000))
    assert y["er"][-1] == -1.0
    assert y["load_time_constant"][-1] == 0.6


def test_it_starts_where_it_is_told():
    block = FuzzyInertiaEstimator(**TABLES, initial_er=-0.5).block(T_S)
    assert block.outputs[0].start == pytest.approx(0.4)
    assert run(block, np.zeros((1, 3)))[0, 0] == pytest.approx(0.4)


def test_the_dead_zone_is_continuous():
    assert [dead_zone(x, 0.5) for x in (-1.0, -0.5, 0.2, 0.5, 0.75)] == [-0.5, 0.0, 0.0, 0.0, 0.25]


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"er_centres": (0.0, -1.0, 1.0)}, "ascending"),
        ({"k_t": ((1.0, 2.0),) * 3}, "3 rows of 3"),
        ({"time_constants": ((0.0,) * 3,) * 3}, "above 0"),
        ({"latch_time": 0.0}, "latch_time"),
    ],
)
def test_faults(changed, named):
    with pytest.raises(ControllerError, match=named):
        FuzzyInertiaEstimator(**{**TABLES, **changed})
