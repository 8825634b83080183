"""A step begins where the last one ended, up to rounding and no further, at any start time."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fmus.packaging.plant.build import cached_fmu
from tests.fmus.packaging.calls import everything
from tests.fmus.packaging.raw import CO_SIMULATION, ERROR, OK, Raw

STARTS = st.sampled_from([0.0, -1.0, 1e3, -86400.0, 1.7e9])
STEPS = st.sampled_from([1e-4, 1e-3, 0.1, 1 / 3])


@pytest.fixture(params=[2, 3], ids=["FMI 2", "FMI 3"])
def fmu(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Raw]:
    made = Raw(cached_fmu(everything, request.param), CO_SIMULATION, tmp_path)
    yield made
    made.free()


def start(fmu: Raw, time: float) -> None:
    assert fmu.call("Reset") == OK
    assert fmu.set("state", 1e-3) == OK
    assert fmu.enter_initialization(time) == OK
    assert fmu.call("ExitInitializationMode") == OK


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(STARTS, STEPS)
def test_multiplied_and_added_times_meet(fmu: Raw, begin: float, length: float) -> None:
    for multiplied in (True, False):
        start(fmu, begin)
        time = begin
        for k in range(100):
            assert fmu.step(begin + k * length if multiplied else time, length) == OK
            time += length


@pytest.mark.parametrize("begin", [0.0, 1e3, 1.7e9])
@pytest.mark.parametrize("gap", [1.0, 1e-3, -1e-3])
def test_a_gap_is_refused(fmu: Raw, begin: float, gap: float) -> None:
    start(fmu, begin)
    assert fmu.step(begin, 0.1) == OK
    assert fmu.step(begin + 0.1 + gap, 0.1) == ERROR
    assert "stands at" in fmu.messages[-1][1]
    assert fmu.step(begin + 0.1, 0.1) == OK
