"""Instances of FMUs, which are freed when a test ends."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from controllers.core.block import Block
from harness.export.controller import controller_fmu
from tests.fmus.packaging.instances import Instance, load

NewInstance = Callable[..., Instance]


@pytest.fixture(params=[2, 3])
def version(request: pytest.FixtureRequest) -> int:
    return int(request.param)


@pytest.fixture
def new_instance(tmp_path: Path) -> Iterator[NewInstance]:
    made: list[Instance] = []

    def make(
        block: Block,
        version: int,
        sample_time: float = 0.01,
        *,
        start: bool = True,
        logging: bool = False,
        phase: float = 0.0,
    ) -> Instance:
        path = controller_fmu(block, "block", sample_time, version, phase=phase)
        instance = load(path, tmp_path / f"{version}-{len(made)}")
        instance.instantiate(logging=logging)
        if start:
            instance.initialize()
        made.append(instance)
        return instance

    yield make
    for instance in made:
        instance.fmu.freeInstance()
