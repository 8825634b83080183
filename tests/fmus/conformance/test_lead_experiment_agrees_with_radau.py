"""In the lead experiment each state stays within 1e-5 of its range of an independent integration.

The experiment runs in closed loop with noise, at 0.01 s; then each plant is integrated by Radau
under exactly the inputs that it was given.
"""

import numpy as np
import pytest

from fmus.plant import Plant
from harness import registry
from harness.experiment.experiment import Experiment
from harness.results.result import Result
from tests.fmus.conformance.excitation import held_rows
from tests.fmus.conformance.radau import held_reference

SHARE = 1e-5
EXPERIMENT = "ahn2009/figure_11"


def experiment(stop_time: float, version: int) -> tuple[dict[str, Plant], Result]:
    """Plants by component, and a result with their inputs and states."""
    settings = {"stop_time": stop_time, "fmi_version": version}
    loaded = Experiment.load(registry.experiment(EXPERIMENT), settings)
    components = loaded.spec.components.items()
    plants = {name: registry.plant(c.fmu) for name, c in components if hasattr(c, "fmu")}
    bench = loaded.bench("pid")
    bench.record = tuple(
        f"{name}.{variable.name}"
        for name, plant in plants.items()
        for variable in (*plant.inputs, *plant.states)
    )
    return plants, bench.run()


def shares(plants: dict[str, Plant], result: Result) -> dict[str, float]:
    """Largest error of each state of each plant over the state's range."""
    found = {}
    for name, plant in plants.items():
        inputs, states = held_rows(plant, result, name)
        exact = held_reference(plant, inputs, 0.01)
        error = np.abs(states - exact).max(axis=0) / np.ptp(exact, axis=0)
        found |= {f"{name}.{s.name}": e for s, e in zip(plant.states, error, strict=True)}
    return found


def test_beginning() -> None:
    found = shares(*experiment(0.5, 3))
    assert max(found.values()) <= SHARE, found


def test_both_versions_run_it_alike() -> None:
    """To the last bit, so that the reference of one is that of the other."""
    assert np.array_equal(experiment(10.0, 2)[1].data, experiment(10.0, 3)[1].data)


@pytest.mark.slow
def test_whole() -> None:
    found = shares(*experiment(10.0, 3))
    assert max(found.values()) <= SHARE, found
