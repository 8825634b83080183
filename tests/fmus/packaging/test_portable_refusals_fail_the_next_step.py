"""A portable FMU never goes to Fatal over a refused call: it says so and fails its next step."""

from collections.abc import Iterator
from ctypes import c_double, c_size_t, c_uint
from pathlib import Path

import pytest

from fmus.packaging.plant.build import cached_fmu
from tests.fmus.packaging.calls import everything
from tests.fmus.packaging.raw import CO_SIMULATION, DISCARD, ERROR, OK, Raw


@pytest.fixture(params=[2, 3], ids=["FMI 2", "FMI 3"])
def fmu(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Raw]:
    made = Raw(cached_fmu(everything, request.param, portable=True), CO_SIMULATION, tmp_path)
    assert made.set("state", 1e-3) == OK  # far from where it escapes
    made.bring_to("step")
    yield made
    made.free()


def fails_once(fmu: Raw, *words: str, time: float = 0.0, length: float = 0.1) -> None:
    """The step fails with the words in the log, the one after it is done."""
    assert fmu.step(time, length) == (DISCARD if fmu.version == 2 else ERROR)
    assert all(word in fmu.messages[-1][1] for word in words), fmu.messages
    assert fmu.messages[-1][0] == ERROR
    assert fmu.step(fmu.get("time"), 0.1) == OK


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_value_that_is_not_finite(fmu: Raw, value: float) -> None:
    for _ in range(15):
        assert fmu.set("input", value) == OK
        assert "finite" in fmu.messages[-1][1]
        fails_once(fmu, "'input' cannot be set to", "was refused", time=fmu.get("time"))
    assert fmu.get("input") == 0.0


def test_a_value_reference_that_no_variable_has(fmu: Raw) -> None:
    reference, number = (c_uint * 1)(999), (c_double * 1)(1.0)
    more = (c_size_t(1),) if fmu.version == 3 else ()
    kind = "Real" if fmu.version == 2 else "Float64"
    assert fmu.call(f"Get{kind}", reference, c_size_t(1), number, *more) == OK
    assert number[0] != number[0]
    fails_once(fmu, "999")


@pytest.mark.parametrize(("time", "length", "word"), [
    (0.1, 0.0, "above 0"), (0.1, -1.0, "above 0"), (1.0, 0.1, "stands at 0.1"),
])  # fmt: skip
def test_an_illegal_step(fmu: Raw, time: float, length: float, word: str) -> None:
    assert fmu.step(0.0, 0.1) == OK
    fails_once(fmu, word, time=time, length=length)


def test_the_first_step_begins_at_the_start_time(fmu: Raw) -> None:
    assert fmu.call("Reset") == OK
    assert fmu.set("state", 1e-3) == OK
    assert fmu.enter_initialization(5.0) == OK
    assert fmu.call("ExitInitializationMode") == OK
    assert fmu.step(5.0, 0.1) == OK, fmu.messages
    assert fmu.get("time") == 5.1


def test_it_is_open_until_then_and_gone_after_reset(fmu: Raw) -> None:
    assert fmu.set("fixed", 2.0) == OK
    assert fmu.call("Reset") == OK
    fmu.bring_to("step")
    assert fmu.step(0.0, 0.1) == OK
