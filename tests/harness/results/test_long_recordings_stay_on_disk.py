"""A long run in a folder is converted and read a part at a time: the memory that it takes does not
grow with its rows, and what is read is what was recorded."""

import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from harness.errors import RecordingError
from harness.results import storage
from harness.results.recording import Column, Recording, read_recording

ROOT = Path(__file__).parents[3]
COLUMNS = (Column("x"), Column("n", type="int64"), Column("on", type="boolean"),
           Column("word", type="text"))  # fmt: skip
RECORD = """
import re, sys
from pathlib import Path
import numpy as np
from harness.results.recording import Column, Recording
recording = Recording([Column(name) for name in "abcd"], Path(sys.argv[1]))
rows = np.random.default_rng(1).standard_normal((10_000, 4))
for part in range(int(sys.argv[2])):
    recording.append(np.arange(10_000.0) + 10_000 * part, rows)
result = recording.finish()
assert result["d"][-1] == rows[-1, 3] and len(result.time) == 10_000 * int(sys.argv[2])
print(int(re.search(r"VmHWM:\\s*(\\d+)", Path("/proc/self/status").read_text())[1]) / 1024)
"""


def peak(folder: Path, parts: int) -> float:
    """MB that a process takes which records so many times 10 000 rows, and looks at two columns."""
    command = [sys.executable, "-c", RECORD, str(folder), str(parts)]
    done = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    return float(done.stdout)


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="memory is read from /proc")
def test_memory_does_not_grow_with_the_rows(tmp_path: Path) -> None:
    """4e6 rows are 160 MB; the two columns that are looked at are 64 MB of it."""
    short, long = peak(tmp_path / "short", 100), peak(tmp_path / "long", 400)
    assert long - short < 140.0, (short, long)


def record(folder: Path) -> Recording:
    recording = Recording(COLUMNS, folder)
    recording.add_texts(["", "a", "é"])
    rows = np.empty((3, 4))
    rows[:, 0], rows[:, 2] = [0.1, -0.0, 1 / 3], [1.0, 0.0, 1.0]
    rows[:, 1] = np.array([2**63 - 1, 0, -1]).view(np.float64)
    rows[:, 3] = np.array([1, 2, 0]).view(np.float64)
    recording.append(np.array([0.0, 1.0, 2.0]), rows)
    return recording


@pytest.mark.parametrize("sealed", [True, False], ids=["files", "stream"])
def test_a_column_is_read_when_it_is_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sealed: bool
) -> None:
    monkeypatch.setattr(storage, "_READ_AT_ONCE", 0)
    record(tmp_path / "run").finish("ended", keep_stream=not sealed)
    result = read_recording(tmp_path / "run")
    assert isinstance(result.values, storage.StoredColumns)
    for one in (result, pickle.loads(pickle.dumps(result))):
        assert list(one.values) == ["time", "x", "n", "on", "word"]
        assert one.time.tolist() == [0.0, 1.0, 2.0] and one["x"].tolist() == [0.1, -0.0, 1 / 3]
        assert one["n"].tolist() == [2**63 - 1, 0, -1] and one["word"].tolist() == ["a", "é", ""]
        assert one["on"].dtype == np.bool_ and one["on"].tolist() == [True, False, True]
        assert one.dataframe()["n"].tolist() == [2**63 - 1, 0, -1]
    (tmp_path / "run" / (storage.PARQUET_FILE if sealed else storage.STREAM_FILE)).unlink()
    with pytest.raises(RecordingError, match=f"cannot read the results in {tmp_path}"):
        result["x"]


def test_a_short_run_outlives_its_folder(tmp_path: Path) -> None:
    result = record(tmp_path / "run").finish()
    for file in (tmp_path / "run").iterdir():
        file.unlink()
    assert result["x"].tolist() == [0.1, -0.0, 1 / 3]
    assert not result.time.flags.writeable and not result["n"].flags.writeable
