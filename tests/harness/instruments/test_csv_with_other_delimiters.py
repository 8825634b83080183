"""Semicolons, with decimal commas or points, and tabs mean what commas mean."""

from pathlib import Path

import pytest

from harness import simulate
from harness.instruments.csv_signal import read_csv_table
from harness.registry import plant_fmu
from tests.harness.simulation.fmus import needs_compiler

VALUES = [[0.0, -1.5], [0.25, 2e-3], [1.0, 4.0]]
TEXT = "time,coupling_force\n0.0,1.5\n0.5,2.5\n"
TEXTS = {
    "quoted": '"time","x[1,2]"\n0,-1.5\n0.25,2e-3\n1,4\n',
    "semicolons": "time;x[1,2]\n0;-1.5\n0.25;2e-3\n1;4\n",
    "decimal commas": "Time; x[1,2]\n0,0; -1,5\n,25;2e-3\n1;4,0\n",
    "quoted semicolons": '"time";"x[1,2]"\n"0";"-1,5"\n"0,25";"2e-3"\n"1";"4"\n',
    "tabs": "time\tx[1,2]\n0\t-1.5\n0.25\t2e-3\n1\t4\n",
    "declared": "sep=|\ntime|x[1,2]\n0|-1.5\n0.25|2e-3\n1|4\n",
}


@pytest.mark.parametrize("as_text", [False, True])
@pytest.mark.parametrize("name", sorted(TEXTS))
def test_the_values_are_the_same(name: str, as_text: bool, tmp_path: Path) -> None:
    path = tmp_path / "in.csv"
    path.write_text(TEXTS[name], encoding="utf-8")
    table = read_csv_table(path, as_text=as_text)
    rows = zip(table.seconds.tolist(), table.column("x[1,2]").tolist(), strict=True)
    assert [list(row) for row in rows] == VALUES


@needs_compiler
def test_inputs_of_a_simulation_may_have_them(tmp_path: Path) -> None:
    texts = {"german": "time;coupling_force\n0,0;1,5\n0,5;2,5\n", "plain": TEXT}
    found = []
    for name, text in texts.items():
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        result = simulate(
            plant_fmu("oscillator_left", 3), inputs=path, stop_time=0.5, output_interval=0.25,
            output_variables=("coupling_force",),
        )  # fmt: skip
        found.append(result["coupling_force"].tolist())
    assert found[0] == found[1]
    assert found[0][0] == 1.5 != found[0][-1]
