"""What is recorded comes back bit for bit: from memory, from Parquet, from CSV."""

import csv
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow.parquet as parquet
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from harness.instruments.csv_signal import read_csv_table
from harness.results.recording import Column, Recording, read_recording

AWKWARD = Column("der(x)", "m/s", "speed")
COLUMNS = (AWKWARD, Column("a[1,2]", "N"), Column('say "so"'))
ROWS = arrays(np.float64, st.tuples(st.integers(1, 30), st.just(3)), elements=st.floats())


def times(n: int) -> np.ndarray:
    return np.arange(n) * 10_000_000 / 1e9


def record(folder: Path | None, rows: np.ndarray, chunk: int = 7) -> Recording:
    recording = Recording(COLUMNS, folder)
    for begin in range(0, len(rows), chunk):
        part = slice(begin, begin + chunk)
        recording.append(times(len(rows))[part], rows[part])
    return recording


def same_bits(a: np.ndarray, b: np.ndarray) -> bool:
    nan = np.isnan(a)
    return bool(np.array_equal(nan, np.isnan(b)) and a[~nan].tobytes() == b[~nan].tobytes())


@settings(max_examples=40, deadline=None)
@given(ROWS)
def test_all_forms_hold_the_same_bits(rows: np.ndarray) -> None:
    with TemporaryDirectory() as scratch:
        folder = Path(scratch) / "run"
        result = record(folder, rows).finish()
        assert same_bits(result.data, rows)
        assert same_bits(read_recording(folder).data, rows)
        assert same_bits(record(None, rows).finish().data, rows)
        with (folder / "results.csv").open(newline="") as file:
            header, *lines = csv.reader(file)
    assert header == ["time", *(column.name for column in COLUMNS)]
    parsed = np.array([[float(cell) for cell in line] for line in lines])
    assert same_bits(parsed[:, 1:], rows)
    assert same_bits(parsed[:, 0], times(len(rows)))
    digits = [len(cell.split("e")[0].replace(".", "").strip("-0")) for row in lines for cell in row]
    assert max(digits) <= 17


def test_the_text_of_a_csv_file(tmp_path: Path) -> None:
    rows = np.array([[1.0, 0.0, 0.1], [True, -2.5, 1 / 3]])
    record(tmp_path / "run", rows).finish()
    assert (tmp_path / "run" / "results.csv").read_text() == (
        '"time","der(x)","a[1,2]","say ""so"""\n0,1,0,0.1\n0.01,1,-2.5,0.3333333333333333\n'
    )


def test_our_own_csv_is_read_by_our_csv_signal(tmp_path: Path) -> None:
    rows = np.random.default_rng(1).standard_normal((500, 3))
    record(tmp_path / "run", rows).finish()
    table = read_csv_table(tmp_path / "run" / "results.csv")
    assert np.array_equal(table.times_ns, np.arange(500) * 10_000_000)
    assert table.column("a[1,2]").tobytes() == rows[:, 1].tobytes()


def test_parquet_carries_units_and_descriptions(tmp_path: Path) -> None:
    record(tmp_path / "run", np.zeros((3, 3))).finish()
    schema = parquet.read_schema(tmp_path / "run" / "results.parquet")
    assert schema.names == ["time", "der(x)", "a[1,2]", 'say "so"']
    assert schema.field("time").metadata[b"unit"] == b"s"
    assert schema.field("der(x)").metadata == {b"unit": b"m/s", b"description": b"speed"}
    assert read_recording(tmp_path / "run").columns == COLUMNS


def test_many_small_chunks_become_few_row_groups(tmp_path: Path) -> None:
    rows = np.random.default_rng(1).standard_normal((600_000, 3))
    result = record(tmp_path / "run", rows, chunk=5000).finish()
    assert parquet.ParquetFile(tmp_path / "run" / "results.parquet").num_row_groups == 2
    assert result.data.tobytes("C") == rows.tobytes("C")
    assert sorted(one.name for one in (tmp_path / "run").iterdir()) == [
        "manifest.json",
        "results.csv",
        "results.parquet",
    ]


def test_a_run_without_rows_is_a_result_too(tmp_path: Path) -> None:
    for folder in (None, tmp_path / "run"):
        result = Recording(COLUMNS, folder).finish()
        assert result["der(x)"].shape == (0,)
        assert result.status.until is None
