"""Clocks in event mode: periodic, countdown, changing and triggered ones, and output clocks."""

import numpy as np
import pytest

from harness import simulate
from harness.results.result import Result
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler
CLOCKS = ["tick", "down", "user", "even", "changing", "ticks", "downs", "users", "changes"]


@pytest.fixture(scope="module", params=["co-simulation", "model-exchange"])
def result(request: pytest.FixtureRequest) -> Result:
    trigger = ([0.0, 0.33, 0.4, 0.77], [0, 1, 0, 1])
    return simulate(
        model_fmu("3"), interface_type=request.param, stop_time=1.0, output_interval=0.5,
        inputs={"user": trigger}, output_variables=CLOCKS,
    )  # fmt: skip


def ticks(result: Result, clock: str) -> list[float]:
    return list(result.time[np.flatnonzero(result[clock])])


def test_a_periodic_clock_ticks_on_its_grid_from_the_start(result: Result) -> None:
    assert ticks(result, "tick") == [i / 10 for i in range(11)]
    assert result["ticks"][-1] == 11


def test_a_countdown_ticks_after_the_interval_that_the_fmu_set(result: Result) -> None:
    """Every third tick, at 0.2, 0.5 and 0.8 s, starts it."""
    assert np.allclose(ticks(result, "down"), [0.25, 0.55, 0.85], rtol=1e-15)
    assert result["downs"][-1] == 3


def test_a_changing_clock_ticks_after_each_new_interval(result: Result) -> None:
    """The interval doubles at each tick: 0.4, 0.8, …"""
    assert ticks(result, "changing") == [0.0, 0.4] and result["changes"][-1] == 2


def test_a_triggered_clock_ticks_when_the_user_says(result: Result) -> None:
    assert ticks(result, "user") == [0.33, 0.77] and result["users"][-1] == 2


def test_an_output_clock_is_read_while_it_is_active(result: Result) -> None:
    assert ticks(result, "even") == [0.1, 0.3, 0.5, 0.7, 0.9]


def test_clocked_values_are_held_between_ticks(result: Result) -> None:
    """The FMU refuses to give them when their clock is not active."""
    at = {float(t): int(n) for t, n in zip(result.time, result["ticks"], strict=True)}
    assert at[0.33] == 4 and at[0.3] == 4 and at[0.77] == 8


def test_without_event_mode_no_clock_ticks_and_a_note_says_so() -> None:
    result = simulate(model_fmu("3"), stop_time=0.3, step_size=0.1, event_mode=False,
                      output_variables=["tick", "x"])  # fmt: skip
    assert not result["tick"].any() and any("never tick" in note for note in result.notes)
