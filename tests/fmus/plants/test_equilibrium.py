"""The start state is at rest, and 2000 N can be held at rest."""

import numpy as np
import pytest

from fmus.disturbance_generator.model import plant as generator
from fmus.hybrid_actuator.model import plant as hybrid
from fmus.linearization import EquilibriumError, equilibrium, linearize
from tests.fmus.plants.bench import PLANTS, Simulator


@pytest.mark.parametrize("plant", PLANTS, ids=lambda plant: plant.name)
def test_nothing_moves_at_the_start_without_command(plant):
    simulator = Simulator(plant)
    rate = simulator.rate(simulator.start, np.array([v.start for v in plant.inputs]))
    # Exactly zero but for the rounding of the saturations at zero.
    assert np.all(np.abs(rate) <= 1e-12 * simulator.nominal)


@pytest.mark.parametrize(
    ("plant", "inputs", "output", "target"),
    [
        (hybrid, (0.0, 0.0, 0.0), "force", 2000.0),
        (hybrid, (0.0, 0.0, 0.0), "force", 15000.0),
        (generator, (0.0, 2000.0), "position", 0.05),
    ],
)
def test_a_working_point_is_at_rest_and_stable(plant, inputs, output, target):
    x, u = equilibrium(plant, inputs, output, target)
    simulator = Simulator(plant)
    assert np.all(np.abs(simulator.rate(x, u)) < 1e-5 * simulator.nominal)
    assert np.all(linearize(plant, x, u).eigenvalues().real < 0)


def test_a_force_beyond_stall_is_refused():
    with pytest.raises(EquilibriumError, match="force"):
        equilibrium(hybrid, (0.0, 0.0, 0.0), "force", 40000.0)
