"""Inputs over time against x' = u - k x: jumps, ramps, functions, tunables, in every kind."""

import math
from pathlib import Path

import numpy as np
import pytest

from harness import simulate
from harness.errors import SimulationError, UsageError
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler
CASES = [
    ("1-slave", None), ("1-model", None), ("2", "co-simulation"), ("2", "model-exchange"),
    ("3", "co-simulation"), ("3", "model-exchange"),
]  # fmt: skip
SOLVED = [case for case in CASES if case[1] == "model-exchange" or case[0] == "1-model"]


@pytest.mark.parametrize(("kind", "interface"), CASES)
def test_a_jump_acts_at_its_own_time(tmp_path: Path, kind: str, interface: str | None) -> None:
    """Also off the grid of the steps: x = e^-t, from 0.33 s on 2 + (x(0.33) - 2) e^-(t - 0.33)."""
    table = tmp_path / "in.csv"
    table.write_text("time,u\n0,0\n0.33,0\n0.33,2\n1,2\n")
    result = simulate(
        model_fmu(kind), interface_type=interface, stop_time=1.0, output_interval=0.1,
        inputs=table, relative_tolerance=1e-9, output_variables=["x", "u"],
    )  # fmt: skip
    t = result.time
    later = 2.0 + (math.exp(-0.33) - 2.0) * np.exp(-(t - 0.33))
    exact = np.where(t < 0.33, np.exp(-t), later)
    assert np.abs(result["x"] - exact).max() < (1e-7 if (kind, interface) in SOLVED else 1e-12)
    sides = result["u"][t == 0.33].tolist()
    has_events = (kind, interface) in SOLVED or kind == "3"
    assert sides == ([0.0, 2.0] if has_events else [0.0])


@pytest.mark.parametrize(("kind", "interface"), SOLVED)
@pytest.mark.parametrize("as_function", [True, False])
def test_a_ramp_is_solved_to_the_tolerance(
    kind: str, interface: str | None, as_function: bool
) -> None:
    """x' = t - x with x(0) = 1: x = t - 1 + 2 e^-t."""
    ramp: object = (lambda t: t) if as_function else ([0.0, 1.0], [0.0, 1.0])
    result = simulate(
        model_fmu(kind), interface_type=interface, stop_time=1.0, output_interval=0.1,
        inputs={"u": ramp}, relative_tolerance=1e-9,
    )  # fmt: skip
    exact = result.time - 1.0 + 2.0 * np.exp(-result.time)
    assert np.abs(result["x"] - exact).max() < 1e-7


@pytest.mark.parametrize(("kind", "interface"), SOLVED)
def test_the_solver_meets_every_corner_of_an_input(kind: str, interface: str | None) -> None:
    """With k = 0, x is the integral of u: a pulse of 2 ms between steps of 20 ms is not missed."""
    pulse = ([0.0, 0.505, 0.506, 0.507, 1.0], [0.0, 0.0, 100.0, 0.0, 0.0])
    result = simulate(
        model_fmu(kind), interface_type=interface, stop_time=1.0, output_interval=0.5,
        inputs={"u": pulse}, start_values={"k": 0.0, "h": 100.0}, relative_tolerance=1e-9,
    )  # fmt: skip
    assert result["x"][-1] == pytest.approx(1.0 + 0.1, abs=1e-7)


def test_after_a_jump_its_later_value_counts_from_the_first_evaluation() -> None:
    """By Euler's method with k = 0, x grows by 0.25 u(t) a step; u jumps from 0 to 2 at 0.5 s."""
    result = simulate(
        model_fmu("2"), interface_type="me", solver="euler", stop_time=1.0, step_size=0.25,
        inputs={"u": ([0.0, 0.5, 0.5], [0.0, 0.0, 2.0])}, start_values={"k": 0.0},
        output_variables=["x"],
    )  # fmt: skip
    last = dict(zip(result.time.tolist(), result["x"].tolist(), strict=True))
    assert [last[t] for t in (0.0, 0.25, 0.5, 0.75, 1.0)] == [1.0, 1.0, 1.0, 1.5, 2.0]


def test_co_simulation_holds_an_input_from_each_communication_point() -> None:
    result = simulate(model_fmu("2"), stop_time=1.0, step_size=0.125, inputs={"u": lambda t: t})
    x = [1.0]
    for i in range(8):
        u = i / 8
        x.append(u + (x[-1] - u) * math.exp(-0.125))
    assert np.allclose(result["x"], x, rtol=1e-13)


@pytest.mark.parametrize(("kind", "interface"), [c for c in CASES if c[0] in "23"])
def test_a_tunable_parameter_changes_during_the_run(kind: str, interface: str) -> None:
    result = simulate(
        model_fmu(kind), interface_type=interface, stop_time=1.0, output_interval=0.25,
        inputs={"k": ([0.0, 0.5], [1.0, 3.0])}, relative_tolerance=1e-9,
    )  # fmt: skip
    assert result["x"][-1] == pytest.approx(math.exp(-0.5 - 1.5), abs=1e-7)


@pytest.mark.parametrize("interface", ["co-simulation", "model-exchange"])
@pytest.mark.parametrize("fault", [ZeroDivisionError("by nought"), KeyError("gone")])
def test_a_function_that_fails_ends_the_run_and_rows_are_kept(
    interface: str, fault: Exception
) -> None:
    def broken(t: float) -> float:
        if t > 0.5:
            raise fault
        return 0.0

    with pytest.raises(
        SimulationError, match=r"function of input 'u' failed at t = 0\.[56]"
    ) as caught:
        simulate(model_fmu("2"), interface_type=interface, stop_time=1.0, output_interval=0.1,
                 inputs={"u": broken})  # fmt: skip
    assert caught.value.result.time[-1] >= 0.4
    assert caught.value.result.status.state == "incomplete"


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        ({"v": 1.0}, "'v' cannot be given over time: it is an output; .*did you mean|legal names"),
        ({"uu": 1.0}, "there is none in the FMU"),
        ({"e": 1.0}, "it is a fixed parameter"),
        ({"u": ([0.0, 1.0], [1.0])}, "has 2 times and 1 values"),
        ({"u": ([1.0, 0.0], [1.0, 2.0])}, "time goes back from 1.0 s to 0.0 s"),
        ({"u": [1.0, 2.0]}, r"has 1 element\(s\), but a row of 2 was given"),
    ],
)
def test_inputs_that_cannot_be_meant(inputs: dict[str, object], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        simulate(model_fmu("2"), inputs=inputs)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time,u\n0,abc\n", "variable 'u' of type Real cannot be 'abc'"),
        ("time,u\n1,0\n0,0\n", "time goes back"),
        ("time,h\n0,0\n", "no column for an input"),
        ("u\n0\n", "no column 'time'"),
        ("time,o_in\n0,3.5\n", "cannot be '3.5'; its items are 1 'low', 7 'high'"),
    ],
)
def test_files_that_cannot_be_meant(tmp_path: Path, text: str, words: str) -> None:
    table = tmp_path / "in.csv"
    table.write_text(text)
    with pytest.raises(Exception, match=words):
        simulate(model_fmu("2"), inputs=table)


def test_items_of_an_enumeration_go_by_name(tmp_path: Path) -> None:
    table = tmp_path / "in.csv"
    table.write_text("Time, o_in, b_in\n0, high, True\n")
    result = simulate(model_fmu("2"), stop_time=0.1, step_size=0.1, inputs=table)
    assert result["o_out"][-1] == 7 and result["b_out"][-1]


@pytest.mark.parametrize("interface", ["co-simulation", "model-exchange"])
def test_a_function_for_what_is_held_acts_at_the_next_row(interface: str) -> None:
    result = simulate(
        model_fmu("3"), interface_type=interface, stop_time=1.0, output_interval=0.25,
        inputs={"Int16_in": lambda t: int(t >= 0.4)}, output_variables=["Int16_out"],
    )  # fmt: skip
    at = dict(zip(result.time.tolist(), result["Int16_out"].tolist(), strict=True))
    assert (at[0.25], at[0.5], at[1.0]) == (0, 1, 1)


def test_values_that_are_not_finite_are_named() -> None:
    result = simulate(model_fmu("2"), stop_time=1.0, step_size=0.5, output_variables=["x"],
                      inputs={"u": ([0.0, 0.5, 0.5], [0.0, 0.0, math.inf])})  # fmt: skip
    assert result.not_finite == ("x is nan at t = 1 s, the first of 1 such rows",)


def test_an_interrupt_keeps_the_rows() -> None:
    def impatient(t: float) -> float:
        if t > 0.5:
            raise KeyboardInterrupt
        return 0.0

    with pytest.raises(SimulationError, match=r"interrupted by Ctrl-C at t = 0\.6 s") as caught:
        simulate(model_fmu("2"), stop_time=1.0, step_size=0.1, inputs={"u": impatient})
    assert len(caught.value.result.time) == 7
