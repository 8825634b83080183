"""The equations are smooth: exact derivatives agree with central differences everywhere."""

import casadi as ca
import numpy as np
import pytest

from fmus.linearization import parameter_values, plant_functions
from tests.fmus.plants.bench import PLANTS, draw

SEED = 3


@pytest.mark.parametrize("plant", PLANTS, ids=lambda plant: plant.name)
def test_jacobian_agrees_with_central_differences(plant):
    """Two step sizes and Richardson's extrapolation: fourth order, so a kink would stand out."""
    f, _ = plant_functions(plant)
    p = parameter_values(plant)
    x, u = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs))
    exact = ca.Function("exact", [x, u], [ca.jacobian(f(x, u, p), x)])
    rng = np.random.default_rng(SEED)
    for _ in range(100):
        point, held = draw(plant, rng)
        slope = exact(point, held).full()
        for i, state in enumerate(plant.states):
            scale = abs(point[i]) if state.unit == "Pa" else state.nominal
            unit = np.eye(point.size)[i]

            def central(h, point=point, unit=unit, held=held):
                difference = f(point + h * unit, held, p) - f(point - h * unit, held, p)
                return difference.full().ravel() / (2 * h)

            h = 1e-3 * scale
            estimate = (4 * central(h / 2) - central(h)) / 3
            size = np.abs(slope[:, i]).max() + np.abs(f(point, held, p).full()).max() / scale
            assert np.abs(estimate - slope[:, i]).max() < 1e-6 * size, state.name
