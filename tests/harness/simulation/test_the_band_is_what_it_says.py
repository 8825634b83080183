"""The tube in time and value: what lies inside and what does not, at its very edges."""

from pathlib import Path

import numpy as np
import pytest

from harness import simulate
from harness.errors import UsageError
from harness.results.comparison import Agreement, compare_with_file, tube
from tests.harness.simulation.fmus import model_fmu, needs_compiler

T = np.linspace(0.0, 1.0, 11)


def test_a_constant_has_the_width_of_the_value_band() -> None:
    low, high = tube(T, T, np.full(11, 5.0), 0.1, 0.25, False)
    assert np.all(low == 4.75) and np.all(high == 5.25)


def test_a_slope_is_widened_by_what_it_does_in_the_time_band() -> None:
    low, high = tube(T[2:-2], T, 3.0 * T, 0.1, 0.0, False)
    assert np.allclose(high - 3.0 * T[2:-2], 0.3) and np.allclose(3.0 * T[2:-2] - low, 0.3)


@pytest.mark.parametrize("held", [True, False])
def test_a_jump_may_come_earlier_or_later_by_the_time_band(held: bool) -> None:
    time, values = np.array([0.0, 0.5, 0.5, 1.0]), np.array([0.0, 0.0, 1.0, 1.0])
    at = np.array([0.39, 0.41, 0.5, 0.59, 0.61])
    low, high = tube(at, time, values, 0.1, 0.0, held)
    assert list(low) == [0.0, 0.0, 0.0, 0.0, 1.0] and list(high) == [0.0, 1.0, 1.0, 1.0, 1.0]


def judged(tmp_path: Path, text: str, band: float | None = None) -> dict[str, Agreement]:
    table = tmp_path / "ref.csv"
    table.write_text(text)
    path = model_fmu("2")
    result = simulate(path, stop_time=1.0, step_size=0.1)
    found, _ = compare_with_file(result, table, band, 0.01)
    return {one.name: one for one in found}


@needs_compiler
def test_the_solution_agrees_and_a_wrong_one_does_not(tmp_path: Path) -> None:
    grid = [i / 10 for i in range(11)]
    right = "\n".join(f"{t},{np.exp(-t)}" for t in grid)
    found = judged(tmp_path, f"time,x\n{right}\n", 0.0)["x"]
    assert found.agrees and (found.inside, found.judged) == (11, 11) and found.largest < 1e-15
    wrong = "\n".join(f"{t},{np.exp(-t) + (t > 0.45) * 0.007}" for t in grid)  # 1 % is 0.0063
    found = judged(tmp_path, f"time,x\n{wrong}\n", 0.0)["x"]
    assert not found.agrees and found.first_outside == 0.5
    assert found.largest == pytest.approx(0.007)


@needs_compiler
def test_discrete_columns_are_held_and_texts_are_equal(tmp_path: Path) -> None:
    rows = ("0,0,false,", "0.25,1,false,", "0.5,2,false,", '0.75,3,0,"x"', '1,4,0,"x"')
    found = judged(tmp_path, "time,counter,b_out,s_out\n" + "\n".join(rows), 0.1)
    assert found["counter"].agrees and found["b_out"].agrees
    assert not found["s_out"].agrees and found["s_out"].first_outside == 0.9


@needs_compiler
def test_a_column_that_was_not_recorded_is_named(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="column 'xx', which was not recorded; did you mean 'x'"):
        judged(tmp_path, "time,xx\n0,1\n")
