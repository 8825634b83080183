"""Mass and energy books close to rounding at every state, by the chain rule along f."""

import casadi as ca
import numpy as np
import pytest

from fmus.linearization import parameter_values, plant_functions
from fmus.plant import Plant
from tests.fmus.plants.bench import AXES, draw

SEED = 1


def along(plant: Plant, output: str) -> ca.Function:
    """(x, u, du/dt) -> (d/dt of `output`, all outputs)."""
    f, h = plant_functions(plant)
    p = parameter_values(plant)
    x, u = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs))
    u_rate = ca.SX.sym("u_rate", len(plant.inputs))
    y = h(x, u, p)[[v.name for v in plant.outputs].index(output)]
    rate = ca.jacobian(y, x) @ f(x, u, p) + ca.jacobian(y, u) @ u_rate
    return ca.Function("along", [x, u, u_rate], [rate, h(x, u, p)])


def samples(plant: Plant, output: str):
    """(rate of `output`, outputs by name, inputs by name) at 300 random states."""
    function, rng = along(plant, output), np.random.default_rng(SEED)
    for _ in range(300):
        x, u = draw(plant, rng)
        inputs = dict(zip((v.name for v in plant.inputs), u, strict=True))
        u_rate = [
            inputs["environment_velocity"] if v.name == "environment_position" else 0.0
            for v in plant.inputs
        ]
        rate, y = function(x, u, u_rate)
        yield float(rate), dict(zip((v.name for v in plant.outputs), y.full().ravel(), strict=True))


@pytest.mark.parametrize("plant", AXES, ids=lambda plant: plant.name)
def test_mass_in_the_chambers_changes_by_what_the_reservoir_gives(plant):
    for rate, y in samples(plant, "fluid_mass"):
        through = abs(y["pump_flow"]) * 870 + abs(y["reservoir_flow"]) + 1.0
        assert abs(rate - y["reservoir_flow"]) < 1e-11 * through


@pytest.mark.parametrize("plant", AXES, ids=lambda plant: plant.name)
def test_stored_energy_changes_by_supply_less_losses(plant):
    for rate, y in samples(plant, "stored_energy"):
        delivered = y["environment_power"] if "environment_power" in y else -y["spring_power"]
        supplied = y["motor_power"] + y["reservoir_power"] - delivered
        size = abs(supplied) + y["dissipated_power"] + 1e5
        assert abs(rate - (supplied - y["dissipated_power"])) < 1e-11 * size
