"""In the lead experiment each state stays within 1e-5 of its range of an independent integration.

The experiment runs in closed loop with noise, at 0.01 s; then each plant is integrated by Radau
under exactly the inputs that it was given.
"""

import numpy as np
import pytest

from harness import registry
from harness.experiment.experiment import Experiment
from tests.fmus.conformance.excitation import held_rows
from tests.fmus.conformance.radau import held_reference

SHARE = 1e-5
EXPERIMENT = "ahn2009/figure_11"


def shares(stop_time: float, version: int) -> dict[str, float]:
    """Largest error of each state of each plant over the state's range."""
    settings = {"stop_time": stop_time, "fmi_version": version}
    experiment = Experiment.load(registry.experiment(EXPERIMENT), settings)
    components = experiment.spec.components.items()
    plants = {name: registry.plant(c.fmu) for name, c in components if hasattr(c, "fmu")}
    bench = experiment.bench("pid")
    bench.record = tuple(
        f"{name}.{variable.name}"
        for name, plant in plants.items()
        for variable in (*plant.inputs, *plant.states)
    )
    result = bench.run()
    found = {}
    for name, plant in plants.items():
        inputs, states = held_rows(plant, result, name)
        exact = held_reference(plant, inputs, 0.01)
        error = np.abs(states - exact).max(axis=0) / np.ptp(exact, axis=0)
        found |= {f"{name}.{s.name}": e for s, e in zip(plant.states, error, strict=True)}
    return found


def test_beginning() -> None:
    found = shares(0.5, 3)
    assert max(found.values()) <= SHARE, found


@pytest.mark.slow
def test_whole(version: int) -> None:
    found = shares(10.0, version)
    assert max(found.values()) <= SHARE, found
