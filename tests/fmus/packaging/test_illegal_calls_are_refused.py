"""Calls out of place, unknown value references and illegal values: Error, a reason, no change."""

import pytest
from fmpy.fmi1 import FMICallException

from tests.fmus.packaging.conftest import NewInstance
from tests.fmus.packaging.instances import Instance
from tests.fmus.packaging.plants import oscillator


@pytest.fixture
def running(new_instance: NewInstance, version: int) -> Instance:
    instance = new_instance(oscillator, version)
    instance.step(0, 0.01)
    return instance


def refused(instance: Instance, *words: str) -> None:
    """The last message is an error that contains the words."""
    assert instance.messages[-1].status == 3
    assert instance.messages[-1].category == "logStatusError"
    for word in words:
        assert word in instance.messages[-1].text, instance.messages[-1].text


@pytest.mark.parametrize("reference", [11, 999, 4294967295])
def test_unknown_value_reference(running: Instance, reference: int) -> None:
    with pytest.raises(FMICallException):
        running.get_references([1, reference])
    refused(running, str(reference), "the last is 10")


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"mass": 1.0}, ("mass", "fixed")),
        ({"stiffness": 1e5}, ("stiffness", "100000", "0 to 10000")),
        ({"damping": -1.0}, ("damping", "-1")),
        ({"force": float("nan")}, ("force", "finite")),
        ({"force": float("inf")}, ("force", "finite")),
        ({"position": 0.0}, ("position", "after initialization")),
        ({"spring_force": 0.0}, ("spring_force", "calculated")),
        ({"time": 0.0}, ("time", "calculated")),
    ],
)
def test_illegal_set_changes_nothing(
    running: Instance, values: dict[str, float], words: tuple[str, ...]
) -> None:
    """Also the legal part of the same call is left undone."""
    names = ("force", "position", "mass", "stiffness", "damping", "time")
    before = running.get(*names)
    with pytest.raises(FMICallException):
        running.set(**({"force": 7.0} if "force" not in values else {}), **values)
    refused(running, *words)
    assert running.get(*names) == before


def test_parameters_and_states_are_set_before_the_run(
    new_instance: NewInstance, version: int
) -> None:
    instance = new_instance(oscillator, version, start=False)
    instance.set(mass=4.0, position=0.2)
    instance.enter_initialization()
    instance.set(velocity=0.5, stiffness=10.0)
    assert instance.get("der(position)", "acceleration") == [0.5, (-1.5 * 0.5 - 10 * 0.2) / 4]
    instance.fmu.exitInitializationMode()
    instance.set(stiffness=20.0)
    assert instance.get("spring_force") == [4.0]


@pytest.mark.parametrize(
    ("time", "step", "word"),
    [(0.01, 0.0, "above 0"), (0.01, -1.0, "above 0"), (0.02, 0.01, "stands at 0.01")],
)
def test_illegal_step(running: Instance, time: float, step: float, word: str) -> None:
    with pytest.raises(FMICallException):
        running.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=step)
    refused(running, word)
    running.step(1, 0.01)
    assert running.get("time") == [0.02]


def test_no_step_passes_the_stop_time(new_instance: NewInstance, version: int) -> None:
    instance = new_instance(oscillator, version, start=False)
    instance.initialize(stop_time=0.1)
    for k in range(10):
        instance.step(k, 0.01)
    with pytest.raises(FMICallException):
        instance.step(10, 0.01)
    refused(instance, "stop time")


def test_calls_out_of_place(new_instance: NewInstance, version: int) -> None:
    instance = new_instance(oscillator, version, start=False)
    for call in (instance.fmu.exitInitializationMode, instance.fmu.terminate):
        with pytest.raises(FMICallException):
            call()
        refused(instance, "'instantiated'")
    with pytest.raises(FMICallException):
        instance.step(0, 0.01)
    refused(instance, "DoStep", "'instantiated'")
    instance.initialize()
    with pytest.raises(FMICallException):
        instance.enter_initialization()
    refused(instance, "'step mode'")
    instance.fmu.terminate()
    with pytest.raises(FMICallException):
        instance.step(0, 0.01)
    refused(instance, "'terminated'")


def test_a_wrong_token_makes_no_instance(new_instance: NewInstance, version: int) -> None:
    instance = new_instance(oscillator, version)
    instance.fmu.guid = "{wrong}"
    component = instance.fmu.component
    with pytest.raises(Exception, match="instantiate"):
        instance.instantiate()
    refused(instance, "{wrong}")
    instance.fmu.component = component
