"""Every version and kind of FMI gives the exact solution: exactly in co-simulation, within the
solver's tolerance in model exchange, with both sides of every event recorded."""

from itertools import pairwise

import numpy as np
import pytest

from harness import simulate
from harness.results.result import Result
from tests.harness.simulation.fmus import ball, bounces, model_fmu, needs_compiler

pytestmark = needs_compiler
STOP = 1.6  # the third bounce is at 1.532 s
CASES = [
    ("1-slave", None), ("1-model", None), ("2", "co-simulation"), ("2", "model-exchange"),
    ("3", "co-simulation"), ("3", "model-exchange"),
]  # fmt: skip


def run(kind: str, interface: str | None, **more: object) -> Result:
    options = {"stop_time": STOP, "output_interval": 0.1, "relative_tolerance": 1e-9} | more
    return simulate(model_fmu(kind), interface_type=interface, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(("kind", "interface"), CASES)
def test_the_trajectory_is_the_solution(kind: str, interface: str | None) -> None:
    result = run(kind, interface)
    solver = interface == "model-exchange" or kind == "1-model"
    tolerance = 2e-7 if solver else 1e-12
    grid = np.array([i for i, t in enumerate(result.time) if round(t * 10) / 10 == t])
    t = result.time[grid]
    assert set(t) == {i / 10 for i in range(17)}
    assert np.abs(result["x"][grid] - np.exp(-t)).max() < tolerance
    assert np.abs(result["h"][grid] - ball(t)).max() < 20 * tolerance
    assert result["counter"][-1] == 6
    assert result.status.state == "complete" and result.notes in ((), result.notes)


@pytest.mark.parametrize(("kind", "interface"), [c for c in CASES if c[1] != "co-simulation"][1:])
def test_both_sides_of_a_bounce_are_recorded(kind: str, interface: str | None) -> None:
    result = run(kind, interface)
    check_bounces(result, 1e-6)


def test_event_mode_of_co_simulation_sees_events_where_they_are() -> None:
    check_bounces(run("3", "co-simulation", output_variables=["h", "v"]), 1e-12)


def check_bounces(result: Result, tolerance: float) -> None:
    v, t = result["v"], result.time
    pairs = [i for i, (a, b) in enumerate(pairwise(v)) if a < 0 < b]
    assert [t[i] == t[i + 1] for i in pairs] == [True] * 3
    assert np.allclose(t[pairs], bounces(STOP), atol=tolerance)
    assert np.allclose(v[[i + 1 for i in pairs]], -0.7 * v[pairs], rtol=1e-9)
    assert np.all(np.diff(t) >= 0.0)


@pytest.mark.parametrize("kind", ["1-model", "2", "3"])
def test_time_events_are_met_exactly(kind: str) -> None:
    interface = None if kind == "1-model" else "model-exchange"
    result = run(kind, interface, output_variables=["counter"])
    counter, t = result["counter"], result.time
    steps = np.flatnonzero(np.diff(counter))
    assert list(t[steps]) == list(t[steps + 1]) == [0.25, 0.5, 0.75, 1.0, 1.25, 1.5]


def test_co_simulation_without_event_mode_records_the_grid_only() -> None:
    result = run("3", "co-simulation", event_mode=False, output_variables=["x", "h"])
    assert list(result.time) == [i / 10 for i in range(17)]
    assert np.abs(result["h"] - ball(result.time)).max() < 1e-12


@pytest.mark.parametrize(("kind", "interface"), CASES)
def test_a_run_repeats_bit_for_bit(kind: str, interface: str | None) -> None:
    first, second = run(kind, interface), run(kind, interface)
    assert np.array_equal(first.time, second.time) and np.array_equal(first.data, second.data)


@pytest.mark.parametrize("kind", ["1-model", "2", "3"])
def test_the_fmu_is_told_of_every_step_of_the_solver(kind: str) -> None:
    interface = None if kind == "1-model" else "model-exchange"
    result = run(kind, interface, output_variables=["completed"], output_interval=0.8)
    assert result["completed"][-1] > 50 > len(result.time) - 20
