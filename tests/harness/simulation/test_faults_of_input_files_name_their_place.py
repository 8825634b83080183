"""A cell that no input can be names file, column and row."""

import re
from pathlib import Path

import pytest

from harness import simulate
from harness.errors import UsageError
from harness.registry import plant_fmu
from tests.harness.simulation.fmus import needs_compiler

pytestmark = needs_compiler


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        ("nan", "nan is not finite"),
        ("-inf", "-inf is not finite"),
        ("", "the cell is empty"),
        ("abc", "cannot be 'abc'"),
    ],
)
def test_the_sentence(cell: str, words: str, tmp_path: Path) -> None:
    table = tmp_path / "in.csv"
    table.write_text(f"time,coupling_force\n0,1\n0.5,{cell}\n")
    place = re.escape(f"{table}, column 'coupling_force', row 2 of the values: ")
    with pytest.raises(UsageError, match=f"^{place}.*{re.escape(words)}"):
        simulate(plant_fmu("oscillator_left", 3), inputs=table, stop_time=1.0, in_process=True)


def test_an_interval_that_no_step_serves_is_said() -> None:
    result = simulate(
        plant_fmu("oscillator_left", 3), stop_time=0.1, step_size=0.01, output_interval=0.004,
        in_process=True,
    )  # fmt: skip
    assert any("0.004 s, which is no multiple" in note for note in result.notes)
