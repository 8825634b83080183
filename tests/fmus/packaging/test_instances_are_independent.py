"""Instances of one FMU in one process do not see each other; reset makes one like new."""

import numpy as np

from tests.fmus.packaging.conftest import NewInstance
from tests.fmus.packaging.instances import Instance
from tests.fmus.packaging.plants import hydraulic

H = 0.01
NAMES = ["position", "velocity", "pressure_a", "pressure_b", "speed", "force"]


def test_interleaved_runs_equal_separate_runs(new_instance: NewInstance, version: int) -> None:
    alone = new_instance(hydraulic, version)
    alone.set(command=100.0)
    expected = alone.run(NAMES, 20, H)
    one, two = new_instance(hydraulic, version), new_instance(hydraulic, version)
    one.set(command=100.0)
    two.set(command=-30.0, bulk=1e9)
    rows = []
    for k in range(20):
        two.step(k, H)
        one.step(k, H)
        rows.append(one.get(*NAMES))
    assert np.array_equal(rows, expected)


def test_interleaved_within_one_library(new_instance: NewInstance, version: int) -> None:
    """Two components of the very same loaded library."""
    first = new_instance(hydraulic, version)
    expected = first.run(NAMES, 10, H)
    component = first.fmu.component
    first.instantiate()
    second_component = first.fmu.component
    first.initialize()
    first.set(command=80.0)
    first.run(NAMES, 10, H)
    first.fmu.component = component
    first.fmu.reset()
    first.initialize()
    assert np.array_equal(first.run(NAMES, 10, H), expected)
    getattr(first.fmu, f"fmi{version}FreeInstance")(second_component)


def test_reset_equals_fresh(new_instance: NewInstance, version: int) -> None:
    fresh = new_instance(hydraulic, version).run(NAMES, 10, H)
    used: Instance = new_instance(hydraulic, version, start=False)
    used.set(position=0.05, mass=500.0, command=90.0)
    used.initialize(tolerance=1e-3)
    used.run(NAMES, 10, H)
    used.fmu.reset()
    used.initialize()
    assert np.array_equal(used.run(NAMES, 10, H), fresh)
