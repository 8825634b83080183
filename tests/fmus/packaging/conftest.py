"""Instances of FMUs, which are freed when a test ends."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fmus.packaging.plant.build import cached_fmu
from fmus.plant import Plant
from tests.fmus.packaging.instances import Instance, load

NewInstance = Callable[..., Instance]


@pytest.fixture(params=[2, 3])
def version(request: pytest.FixtureRequest) -> int:
    return int(request.param)


@pytest.fixture
def new_instance(tmp_path: Path) -> Iterator[NewInstance]:
    """Make instances of a plant's FMU; they are freed when the test ends."""
    made: list[Instance] = []

    def make(plant: Plant, version: int, *, start: bool = True, logging: bool = False) -> Instance:
        folder = tmp_path / f"{plant.name}{version}-{len(made)}"
        instance = load(cached_fmu(plant, version), folder)
        instance.instantiate(logging=logging)
        if start:
            instance.initialize()
        made.append(instance)
        return instance

    yield make
    for instance in made:
        instance.fmu.freeInstance()
    shutil.rmtree(tmp_path, ignore_errors=True)
