"""Cells of every type come back exactly: from memory, the stream, Parquet, CSV and a pickle."""

import csv
import pickle
from pathlib import Path

import numpy as np
import pyarrow.parquet as parquet
import pytest

from harness.errors import RecordingError, UsageError
from harness.results.columns import TYPES, Column
from harness.results.csv_files import write_csv
from harness.results.recording import Recording, read_recording
from harness.results.result import Result

COLUMNS = tuple(Column(f"p.{type_}", "1", "", type_) for type_ in TYPES)
NAMES = [column.name for column in COLUMNS]
VALUES = {
    "p.real": [0.1, -2.5, 1 / 3], "p.float32": [float(np.float32(0.1)), 1.5, -0.0],
    "p.boolean": [True, False, True], "p.clock": [False, True, False],
    "p.integer": [-128, 0, 2**32 - 1], "p.int64": [-(2**63), 2**53 + 1, 2**63 - 1],
    "p.uint64": [0, 2**53 + 1, 2**64 - 1], "p.text": ["", 'say "no", twice', "Grüße"],
    "p.binary": ["", "00ff2c", "00"],
}  # fmt: skip
RAW = {"p.int64": np.int64, "p.uint64": np.uint64, "p.text": np.int64, "p.binary": np.int64}
TEXTS = (["", b"", 'say "no", twice'], [b"\x00\xff,", "Grüße", b"\x00"])
PLACES = {"p.text": [0, 2, 4], "p.binary": [1, 3, 5]}
TYPED = ("float64", "float32", "bool", "bool", "int64", "int64", "uint64")


def record(folder: Path | None) -> Recording:
    """Three rows, two of them at one time; the second half of the texts comes after the first."""
    rows = np.empty((3, len(COLUMNS)))
    for index, name in enumerate(NAMES):
        whole = np.array(PLACES.get(name, VALUES[name]), dtype=RAW.get(name, np.float64))
        rows[:, index] = whole.view(np.float64)
    recording = Recording(COLUMNS, folder)
    recording.add_texts([*TEXTS[0], TEXTS[1][0]])
    recording.append(np.array([0.0, 0.3]), rows[:2])
    recording.add_texts(TEXTS[1][1:])
    recording.append(np.array([0.3]), rows[2:])
    return recording


def check(result: Result) -> None:
    assert result.time.tolist() == [0.0, 0.3, 0.3] and result.names == tuple(NAMES)
    for name, expected in VALUES.items():
        assert result[name].tolist() == expected, name
    assert tuple(result[name].dtype.name for name in NAMES[:7]) == TYPED
    assert result.data.shape == (3, 7) and result.data[:, 2].tolist() == [1.0, 0.0, 1.0]
    assert result.numbers("p.int64").tolist() == [-(2.0**63), 2.0**53, 2.0**63]
    with pytest.raises(UsageError, match=r"'p.text' was recorded as text, where numbers were exp"):
        result.numbers("p.text")


def test_memory_stream_files_and_pickle_hold_the_same(tmp_path: Path) -> None:
    check(record(None).finish())
    recording = record(tmp_path / "run")
    check(read_recording(tmp_path / "run"))
    check(recording.finish())
    check(pickle.loads(pickle.dumps(read_recording(tmp_path / "run"))))


def test_the_files_are_typed(tmp_path: Path) -> None:
    result = record(tmp_path / "run").finish()
    schema = parquet.read_schema(tmp_path / "run" / "results.parquet")
    kinds = ["double", "double", "float", "bool", "bool", *["int64"] * 2, "uint64", "string"]
    assert [str(one) for one in schema.types] == [*kinds, "binary"]
    lines = (tmp_path / "run" / "results.csv").read_text().splitlines()
    assert lines[2:] == [
        '0.3,-2.5,1.5,0,1,0,9007199254740993,9007199254740993,"say ""no"", twice","00ff2c"',
        "0.3,0.3333333333333333,-0,1,0,4294967295,9223372036854775807,18446744073709551615,"
        '"Grüße","00"',
    ]
    write_csv(result, tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "run/results.csv").read_bytes()
    with (tmp_path / "again.csv").open(newline="") as file:
        assert next(csv.reader(file)) == ["time", *NAMES]
    frame = result.dataframe()
    assert tuple(map(str, frame.dtypes))[:7] == TYPED
    assert frame["p.text"].tolist() == VALUES["p.text"] and frame.index.tolist() == [0.0, 0.3, 0.3]


def test_a_run_goes_on_after_its_texts(tmp_path: Path) -> None:
    record(tmp_path / "run").finish("interrupted", keep_stream=True)
    continued = Recording(COLUMNS, tmp_path / "run", continued=2)
    continued.add_texts(["new", b"\x01"])
    row = np.zeros((1, len(COLUMNS)))
    row[0, NAMES.index("p.binary")] = np.int64(1).view(np.float64)
    continued.append(np.array([0.5]), row)
    result = continued.finish()
    assert result["p.text"].tolist() == ["", 'say "no", twice', "new"]
    assert result["p.binary"].tolist() == ["", "00ff2c", "01"]
    assert result["p.uint64"].tolist() == [0, 2**53 + 1, 0]


@pytest.mark.parametrize("place", [-1, 2])
def test_a_text_that_is_not_in_the_table_is_named(tmp_path: Path, place: int) -> None:
    said = f"column 'p.s' got the text number {place} of 2"
    columns = [Column("p.s", type="text")]
    with (
        pytest.raises(RecordingError, match=said),
        Recording(columns, tmp_path / "run") as recording,
    ):
        recording.add_texts(["a", "b"])
        recording.append(np.zeros(1), np.array([[place]]).view(np.float64))


def test_a_type_that_is_none_is_refused() -> None:
    with pytest.raises(RecordingError, match="column 'x' is of type 'double'; expected real, flo"):
        Recording([Column("x", type="double")])
