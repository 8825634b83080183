"""Every plant registered under `fmu_harness.plants`, as an FMU of each kind, built once.

A plant of another package that registers itself is tested as ours are.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from fmus.plant import Plant
from harness import registry
from tests.fmus.conformance.excitation import Excited, excite
from tests.fmus.conformance.radau import held_reference

NAMES = registry.names(registry.PLANTS)
assert NAMES, "no plant is registered; without any, this suite would pass unseen"


@pytest.fixture(scope="package", params=NAMES)
def plant(request: pytest.FixtureRequest) -> Plant:
    found: Plant = registry.plant(request.param)
    return found


@pytest.fixture(scope="package", params=[2, 3], ids=["FMI 2", "FMI 3"])
def version(request: pytest.FixtureRequest) -> int:
    return int(request.param)


@pytest.fixture(scope="package", params=["FMI 2", "FMI 3", "portable", "portable FMI 3"])
def any_fmu(request: pytest.FixtureRequest, plant: Plant) -> Path:
    """Each of the FMUs that a plant can become."""
    version = 3 if request.param.endswith("3") else 2
    return plant.fmu(version, portable=request.param.startswith("portable"))


@pytest.fixture(scope="package")
def fmu(plant: Plant, version: int) -> Path:
    """The native FMU of one version."""
    return plant.fmu(version)


@pytest.fixture(scope="package")
def excited(plant: Plant, version: int) -> Excited:
    """The plant, excited on all its inputs, as the bench runs it."""
    return excite(plant, version)


@cache
def _exact(plant: Plant) -> NDArray[np.float64]:
    run = excite(plant, 3)
    return held_reference(plant, run.inputs, run.step)


@pytest.fixture
def exact(plant: Plant) -> NDArray[np.float64]:
    """States of the excited plant by Radau, shape (rows, states); computed once a plant."""
    return _exact(plant)
