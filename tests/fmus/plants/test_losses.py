"""No loss ever turns into a source: each of them is non-negative at every state."""

from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from fmus.disturbance_generator import model as generator
from fmus.hybrid_actuator import model as hybrid
from fmus.plant import Plant
from tests.fmus.plants.bench import draw

SEED = 2


def loss_function(model) -> tuple[Plant, list[str], ca.Function]:
    plant = model.plant
    x, u, p = (
        {v.name: ca.SX.sym(v.name) for v in group}
        for group in (plant.states, plant.inputs, plant.parameters)
    )
    losses = model.assemble(SimpleNamespace(**x), SimpleNamespace(**u), SimpleNamespace(**p)).losses
    vectors = [ca.vertcat(*symbols.values()) for symbols in (x, u, p)]
    return plant, list(losses), ca.Function("losses", vectors, [ca.vertcat(*losses.values())])


@pytest.mark.parametrize("reservoir", [5e4, 101325.0, 1e6])
@pytest.mark.parametrize("model", [hybrid, generator], ids=lambda model: model.plant.name)
def test_every_loss_is_non_negative(model, reservoir):
    plant, names, function = loss_function(model)
    p = [reservoir if q.name == "reservoir_pressure" else q.value for q in plant.parameters]
    rng = np.random.default_rng(SEED)
    lowest = np.min([function(*draw(plant, rng), p).full().ravel() for _ in range(2000)], axis=0)
    # Rounding: differences of enthalpy times mass flow, each of some 1e5 W.
    assert dict(zip(names, lowest >= -1e-9, strict=True)) == dict.fromkeys(names, True)
