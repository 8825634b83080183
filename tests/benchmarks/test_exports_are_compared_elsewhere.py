"""The benchmark of our exports tells what agrees, what differs and what a tool refuses."""

import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.exports_elsewhere import Export, Row, apart, cell, tried
from harness.export.plant import certified_plant_fmu

ZEROS = """import sys
given = dict(zip(sys.argv[1::2], sys.argv[2::2]))
names = [b for a, b in zip(sys.argv, sys.argv[1:]) if a == "--output-variable"]
step, stop = float(given["--output-interval"]), float(given["--stop-time"])
rows = [[k * step] + [0.0] * len(names) for k in range(round(stop / step) + 1)]
with open(given["--output-file"], "w") as file:
    for row in [["time", *names], *rows]:
        print(*row, sep=",", file=file)
"""
REFUSES = "print('no licence\\nsummary'); raise SystemExit(3)"


def in_a_program(folder: Path, text: str) -> Row:
    """The oscillator in a program that takes the place of fmusim."""
    program = folder / "program"
    program.write_text(f"#!{sys.executable}\n{text}")
    program.chmod(0o755)
    export = Export(certified_plant_fmu("oscillator_left", 2), "plant")
    (row,) = tried(export, {"fmusim": str(program)})
    return row


def test_another_trajectory_differs(tmp_path: Path) -> None:
    row = in_a_program(tmp_path, ZEROS)
    assert row.difference is not None and row.difference > 0.5 and not row.agrees


def test_a_refusal_is_quoted(tmp_path: Path) -> None:
    row = in_a_program(tmp_path, REFUSES)
    assert (row.difference, row.words, row.agrees) == (None, "no licence", False)


@pytest.mark.parametrize("interface", ["co-simulation", "model-exchange"])
def test_fmpy_agrees(interface: str) -> None:
    export = Export(certified_plant_fmu("oscillator_left", 2), "plant", interface)
    (row,) = tried(export, {"fmpy": ""})
    assert row.agrees, row


def test_a_share_of_the_range() -> None:
    ours = np.array([[1.0, 5.0], [3.0, 5.0]])
    assert apart(ours, ours + np.array([[0.0, 0.0], [0.5, 0.0]])) == pytest.approx(0.25)
    assert apart(ours, ours + np.array([[0.0, 0.0], [0.0, 5e-7]])) == pytest.approx(0.1)
    assert apart(0 * ours, 0 * ours + 0.5) == 0.5
    assert apart(ours, ours + np.array([[0.0, 0.0], [np.nan, 0.0]])) == np.inf


def test_a_cell_has_the_worst_export_and_each_refusal_once() -> None:
    rows = [Row("", "", "", found, 1.0, words) for found, words in
            ((0.0, ""), (2e-3, ""), (None, "at a\nno"), (None, "at b\nno"))]  # fmt: skip
    assert cell(rows) == "2 of 4: 2e-03; no"
    assert cell(rows[:1]) == "bit-equal"
