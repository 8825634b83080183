"""The motor never exceeds its torque limit, and at it the shaft stalls."""

from math import pi

import numpy as np
import pytest

from tests.fmus.plants.bench import AXES, Simulator


def value(plant, name: str) -> float:
    return next(q.value for q in plant.parameters if q.name == name)


def into_end_stop(plant):
    end = value(plant, "stroke") / 2
    inputs = (1.0, end, 0.0) if plant.name == "hybrid_actuator" else (1.0, 0.0)
    return Simulator(plant).run(
        lambda t: inputs, 2.0, rtol=1e-6, start={"rod_displacement": end - 0.01}
    )


@pytest.mark.parametrize("plant", AXES, ids=lambda plant: plant.name)
def test_stalled_against_the_end_stop(plant):
    run = into_end_stop(plant)
    limit, displacement = value(plant, "torque_limit"), value(plant, "pump_displacement") / (2 * pi)
    torque, speed = run.output("motor_torque"), run.output("motor_speed")
    assert np.abs(torque).max() < limit
    assert torque[-1] > 0.98 * limit
    # What still turns is the leakage at stall pressure.
    difference = run.output("pressure_a")[-1] - run.output("pressure_b")[-1]
    leakage = (value(plant, "internal_leakage") + value(plant, "external_leakage")) * difference
    assert speed[-1] == pytest.approx(leakage / displacement, rel=0.02)
    assert speed[-1] < 0.16 * value(plant, "rated_speed")
    stall = (torque[-1] - value(plant, "pump_viscous_torque") * speed[-1]) / displacement
    assert difference == pytest.approx(stall, rel=1e-3)


@pytest.mark.parametrize("plant", AXES, ids=lambda plant: plant.name)
def test_shaft_power_stays_within_the_power_limit_at_steady_speed(plant):
    """A load that would take more than rated power slows the motor down."""
    changed = {"pump_viscous_torque": 0.2}
    inputs = (1.0,) + (0.0,) * (len(plant.inputs) - 1)
    run = Simulator(plant, changed).run(lambda t: inputs, 0.2)
    assert run.output("motor_power")[-1] <= value(plant, "power_limit")
    assert run.output("motor_speed")[-1] < 0.6 * value(plant, "rated_speed")
