"""The CSV files of the field's tools are read, and faults in them are named with their row."""

from pathlib import Path

import numpy as np
import pytest
from numpy.random import SeedSequence

from harness.errors import ExperimentError
from harness.instruments.csv_signal import CsvSignal

ROWS = "0,1\n0.5,0\n"


@pytest.mark.parametrize(
    ("text", "column"),
    [
        ('"time","x"\n' + ROWS, "x"),
        ("time,x\n" + ROWS, "x"),
        ("\ufefftime,x\r\n0,1\r\n0.5,0\r\n", "x"),
        ('"time", "der(x)"\n0, 1\n0.5, 0\n', "der(x)"),
        ('"time","a[1,2]"\n' + ROWS, "a[1,2]"),
        ('"sep=,"\n"time","x"\n' + ROWS, "x"),
        ("sep=;\ntime;x\n0;1\n0.5;0\n", "x"),
        ("Time,StepCount,x [0 real output]\n0,0,1\n0.5,1,0\n", "x"),
        ("iterations, time, inst::x[REAL]\n0, 0, 1\n1, 0.5, 0\n", "inst.x"),
        ("time,x\n0,True\n0.5,False\n", "x"),
        ("time,x\n0,1e0\n0.5,-0.0", "x"),
    ],
)
def test_dialect(tmp_path: Path, text: str, column: str) -> None:
    file = tmp_path / "in.csv"
    file.write_text(text, encoding="utf-8", newline="")
    source = CsvSignal(file, column)
    times = np.array([-1, 0, 499_999_999, 500_000_000, 10**12], dtype=np.int64)
    assert source.sampler(SeedSequence(0)).sample(times).tolist() == [1, 1, 1, 0, 0]


def test_interpolation_and_both_sides_of_an_event(tmp_path: Path) -> None:
    file = tmp_path / "in.csv"
    file.write_text("time,x\n0,0\n1,2\n1,10\n2,20\n")
    times = np.array([-5, 0, 250_000_000, 999_999_999, 1_000_000_000, 1_500_000_000, 3 * 10**9])
    linear = CsvSignal(file, "x", "linear").sampler(SeedSequence(0)).sample(times)
    assert np.allclose(linear, [0, 0, 0.5, 2, 10, 15, 20], rtol=0, atol=1e-8)
    assert linear[4] == 10.0
    hold = CsvSignal(file, "x").sampler(SeedSequence(0)).sample(times)
    assert hold.tolist() == [0, 0, 0, 0, 10, 10, 20]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty; a header with the column 'time' was expected"),
        ("time,x\n", "has a header but no rows"),
        ("t,x\n0,1\n", "has no column 'time', only 't', 'x'"),
        ("time,y\n0,1\n", "has no column 'x'"),
        ("time,x,x\n0,1,2\n", "has 2 columns called 'x'"),
        ("time,x\n0,1\n1,\n", "column 'x' has no number in row 2"),
        ("time,x\n0,one\n", "column 'x' holds something that is no number"),
        ("time,x\n0,1\n2,1\n1,1\n", "time goes back from 2 s to 1 s in row 3"),
        ("time,x\n0,1\n1\n", "cannot be read as CSV"),
    ],
)
def test_fault(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "in.csv"
    file.write_text(text)
    with pytest.raises(ExperimentError, match=said) as fault:
        CsvSignal(file, "x")
    assert str(file) in str(fault.value)
