"""A plant's data and its equations name the same things, once each, with units and sources."""

from dataclasses import replace

import numpy as np
import pytest

from fmus.linearization import parameter_values, plant_functions
from fmus.physics.axis_parameters import Value, axis_parameters
from tests.fmus.plants.bench import PLANTS, draw

# The vocabulary that the packaging must be able to take apart into SI base units.
# fmt: off
UNITS = {
    "1", "m", "m/s", "1/m", "m3", "m3/s", "m3/(s.Pa)", "s", "rad/s",
    "kg", "kg/s", "kg/m3", "kg.m2", "N", "N/m", "N.s/m", "N.m", "N.m.s/rad",
    "s2/rad", "s/rad", "rad",
    "Pa", "W", "J", "V", "V/N", "A", "m2", "m/A",
}
# fmt: on


@pytest.mark.parametrize("plant", PLANTS, ids=lambda plant: plant.name)
class TestPlant:
    def test_names_are_unique_across_the_whole_plant(self, plant):
        every = [*plant.states, *plant.inputs, *plant.outputs, *plant.parameters]
        states = {s.name for s in plant.states}
        own = [*plant.states, *plant.inputs, *plant.parameters]
        own += [v for v in plant.outputs if v.name not in states]  # an output may be a state
        names = [v.name for v in own]
        assert len(names) == len(set(names))
        assert {v.unit for v in every} <= UNITS
        assert {d.unit for d in plant.display_units} <= UNITS

    def test_equations_give_every_rate_and_output_and_no_other(self, plant):
        seen = {}

        def spy(x, u, p):
            seen["rates"], seen["outputs"] = plant.equations(x, u, p)
            return seen["rates"], seen["outputs"]

        plant_functions(replace(plant, equations=spy))
        assert set(seen["rates"]) == {s.name for s in plant.states}
        assert set(seen["outputs"]) == {v.name for v in plant.outputs}

    def test_parameters_have_sources_and_lie_within_their_bounds(self, plant):
        for q in plant.parameters:
            assert q.source, q.name
            assert q.minimum is not None and q.maximum is not None, q.name
            assert q.minimum <= q.value <= q.maximum, q.name

    def test_every_input_and_parameter_matters(self, plant):
        """Each reaches a rate or an output somewhere (the structure of the Jacobian)."""
        f, h = plant_functions(plant)
        for position, variables in ((1, plant.inputs), (2, plant.parameters)):
            for i, v in enumerate(variables):
                reached = sum(g.jac_sparsity(0, position).get_col().count(i) for g in (f, h))
                assert reached > 0, v.name


def test_an_unknown_axis_parameter_is_refused():
    with pytest.raises(ValueError, match="piston_size"):
        axis_parameters({"piston_size": Value(1.0, "nowhere")})


def test_a_missing_axis_parameter_is_refused():
    with pytest.raises(ValueError, match="piston_diameter"):
        axis_parameters({})


def test_an_unknown_changed_parameter_is_refused():
    with pytest.raises(KeyError, match="pistons"):
        parameter_values(PLANTS[0], {"pistons": 2.0})


def test_draws_are_repeatable():
    one, two = (draw(PLANTS[0], np.random.default_rng(9)) for _ in range(2))
    assert all((a == b).all() for a, b in zip(one, two, strict=True))
