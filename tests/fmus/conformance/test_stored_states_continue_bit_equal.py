"""A stored state continues to the last bit: here, in a new instance, in a new process."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.fmus.conformance.processes import run_python
from tests.fmus.conformance.stored_run import HALF, drive, restore, serialized, started
from tests.fmus.packaging.instances import Instance


@pytest.fixture
def instance(fmu: Path, tmp_path: Path) -> Iterator[Instance]:
    made = started(fmu, tmp_path / "one")
    yield made
    made.fmu.freeInstance()


def test_in_the_same_instance(fmu: Path, instance: Instance) -> None:
    """The handle is used twice, so taking and setting a state must copy it."""
    drive(instance, fmu, 0, HALF)
    state = instance.fmu.getFMUState()
    first = drive(instance, fmu, HALF, HALF)
    for _ in range(2):
        instance.fmu.setFMUState(state)
        assert np.array_equal(drive(instance, fmu, HALF, HALF), first)
    instance.fmu.freeFMUState(state)


def test_in_a_new_instance(fmu: Path, instance: Instance, tmp_path: Path) -> None:
    drive(instance, fmu, 0, HALF)
    data = serialized(instance)
    first = drive(instance, fmu, HALF, HALF)
    other = started(fmu, tmp_path / "other")
    restore(other, data)
    assert np.array_equal(drive(other, fmu, HALF, HALF), first)
    other.fmu.freeInstance()


def test_in_a_new_process(any_fmu: Path, tmp_path: Path) -> None:
    for task in ("store", "restore"):
        run_python("-m", "tests.fmus.conformance.stored_run", any_fmu, task, tmp_path)
    first, second = np.load(tmp_path / "first.npy"), np.load(tmp_path / "second.npy")
    assert np.array_equal(first, second)
    assert np.ptp(first, axis=0).any()


def test_reset_is_like_new(fmu: Path, instance: Instance) -> None:
    """After other inputs, another tolerance and some steps."""
    first = drive(instance, fmu, 0, HALF)
    instance.fmu.reset()
    instance.initialize(tolerance=1e-3)
    drive(instance, fmu, 0, 5)
    instance.fmu.reset()
    instance.initialize()
    assert np.array_equal(drive(instance, fmu, 0, HALF), first)
