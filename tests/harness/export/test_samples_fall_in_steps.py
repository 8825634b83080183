"""Sample k is computed in the step that begins at or before it is due and ends after it."""

import pytest

from tests.fmus.packaging.instances import Instance
from tests.harness.export.blocks import counter
from tests.harness.export.conftest import NewInstance


def counts(instance: Instance, steps: list[float], start: float = 0.0) -> list[float]:
    """`count` after each of the communication steps."""
    time, found = start, []
    for step in steps:
        instance.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=step)
        time += step
        found += instance.get("count")
    return found


def test_before_the_first_step_outputs_are_start_values(
    version: int, new_instance: NewInstance
) -> None:
    instance = new_instance(counter(), version)
    assert instance.get("count", "echo", "u") == [-1.0, -2.0, 0.25]


def test_a_step_computes_with_the_inputs_set_before_it(
    version: int, new_instance: NewInstance
) -> None:
    instance = new_instance(counter(), version)
    instance.set(u=7.0)
    assert instance.get("echo") == [-2.0]  # no feedthrough
    assert counts(instance, [0.01]) == [1.0]
    assert instance.get("echo") == [7.0]


def test_steps_equal_to_the_sample_time(new_instance: NewInstance) -> None:
    assert counts(new_instance(counter(), 3), [0.01] * 5) == [1, 2, 3, 4, 5]


def test_longer_steps_compute_several_samples(new_instance: NewInstance) -> None:
    assert counts(new_instance(counter(), 3), [0.025, 0.025, 0.05]) == [3, 5, 10]


def test_shorter_steps_hold_the_outputs_in_between(new_instance: NewInstance) -> None:
    instance = new_instance(counter(), 3)
    assert counts(instance, [0.003] * 8) == [1, 1, 1, 2, 2, 2, 3, 3]


def test_inputs_between_samples_are_not_read(new_instance: NewInstance) -> None:
    instance = new_instance(counter(), 3)
    instance.set(u=1.0)
    counts(instance, [0.005])
    instance.set(u=2.0)
    counts(instance, [0.005], start=0.005)
    assert instance.get("count", "echo") == [1.0, 1.0]


def test_a_phase_shifts_the_first_sample(new_instance: NewInstance) -> None:
    instance = new_instance(counter(), 3, phase=0.004)
    assert counts(instance, [0.002] * 8) == [-1, -1, 1, 1, 1, 1, 1, 2]


@pytest.mark.parametrize("sample_time", [0.01, 0.0001, 0.000976])
def test_times_that_gather_rounding_lose_no_sample(
    sample_time: float, new_instance: NewInstance
) -> None:
    instance = new_instance(counter(), 3, sample_time)
    n = 5000  # added up, not multiplied
    assert counts(instance, [sample_time] * n) == list(range(1, n + 1))


@pytest.mark.parametrize("drift", [1e-7, -1e-7])
def test_a_clock_that_runs_off_loses_no_sample(drift: float, new_instance: NewInstance) -> None:
    instance = new_instance(counter(), 3)
    assert counts(instance, [0.01 + drift / 100] * 100) == list(range(1, 101))
