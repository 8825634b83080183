"""Debug messages come by category when asked for; errors come always."""

import pytest
from fmpy.fmi1 import FMICallException

from tests.fmus.packaging.conftest import NewInstance
from tests.fmus.packaging.plants import oscillator


def test_without_debug_logging_a_good_run_is_silent(
    new_instance: NewInstance, version: int
) -> None:
    instance = new_instance(oscillator, version)
    instance.step(0, 0.01)
    assert instance.messages == []


def test_with_debug_logging_all_categories_speak(new_instance: NewInstance, version: int) -> None:
    instance = new_instance(oscillator, version, logging=True)
    instance.step(0, 0.01)
    assert {m.category for m in instance.messages} == {"logEvents", "logSolver"}
    assert all(m.status == 0 for m in instance.messages)


@pytest.mark.parametrize("category", ["logEvents", "logSolver"])
def test_only_the_chosen_category(new_instance: NewInstance, version: int, category: str) -> None:
    instance = new_instance(oscillator, version, start=False)
    instance.fmu.setDebugLogging(True, [category])
    instance.initialize()
    instance.step(0, 0.01)
    assert {m.category for m in instance.messages} == {category}


def test_off_again(new_instance: NewInstance, version: int) -> None:
    instance = new_instance(oscillator, version, logging=True)
    instance.fmu.setDebugLogging(False, [])
    instance.messages.clear()
    instance.step(0, 0.01)
    assert instance.messages == []
    with pytest.raises(FMICallException):
        instance.step(7, 0.01)
    assert [m.category for m in instance.messages] == ["logStatusError"]


def test_an_unknown_category_is_an_error_that_lists_them(
    new_instance: NewInstance, version: int
) -> None:
    instance = new_instance(oscillator, version)
    with pytest.raises(FMICallException):
        instance.fmu.setDebugLogging(True, ["logNoise"])
    (text,) = instance.texts("logStatusError")
    assert "'logNoise'" in text and "logSolver" in text
