"""Two runs never write into one folder, and a full disk leaves what was written before."""

import errno
import fcntl
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from harness.errors import RecordingError
from harness.results.recording import Column, Recording, read_recording

COLUMNS = (Column("x"),)

FULL = """
import resource, sys
from pathlib import Path
import numpy as np
from harness.errors import RecordingError
from harness.results.recording import Column, Recording
recording = Recording([Column("x")], Path(sys.argv[1]))
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, resource.RLIM_INFINITY))
rows = np.arange(1000)
try:
    for chunk in range(100):
        recording.append((rows + 1000 * chunk) * 1e-6, (rows + 1000.0 * chunk)[:, None])
except RecordingError as fault:
    print("append:", fault)
try:
    recording.finish("the disk is full")
except RecordingError as fault:
    print("finish:", fault)
"""


def test_a_folder_that_is_written_into_is_refused(tmp_path: Path) -> None:
    first = Recording(COLUMNS, tmp_path / "run")
    with pytest.raises(RecordingError, match="another run is writing into the run folder"):
        Recording(COLUMNS, tmp_path / "run")
    with pytest.raises(RecordingError, match="another run is writing into the run folder"):
        Recording(COLUMNS, tmp_path / "run", continued=0)
    first.append(np.zeros(1), np.ones((1, 1)))
    assert first.finish().data.tolist() == [[1.0]]
    with pytest.raises(RecordingError, match="is not empty"):
        Recording(COLUMNS, tmp_path / "run")


def test_a_file_system_without_locks_is_used_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(descriptor: int, operation: int) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", refuse)
    with Recording(COLUMNS, tmp_path / "run") as recording:
        recording.append(np.zeros(1), np.ones((1, 1)))
    assert read_recording(tmp_path / "run").data.tolist() == [[1.0]]
    with pytest.raises(RecordingError, match="is not empty"):
        Recording(COLUMNS, tmp_path / "run")


def test_a_full_disk_keeps_the_rows_before(tmp_path: Path) -> None:
    root, folder = Path(__file__).parents[3], tmp_path / "run"
    command = [sys.executable, "-c", FULL, str(folder)]
    done = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True)
    assert done.stderr == ""
    assert "append: cannot write rows into" in done.stdout and "File too large" in done.stdout
    kept = read_recording(folder)
    assert len(kept.time) >= 5000 and len(kept.time) % 1000 == 0
    assert np.array_equal(kept["x"], np.arange(len(kept.time)))
    assert kept.status.state == "incomplete"
    assert not list(folder.glob("*.partial"))


def test_a_continued_recording_keeps_its_first_rows(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    begun = Recording(COLUMNS, folder)
    for chunk in range(3):
        begun.append(np.arange(4.0) + 4 * chunk, np.full((4, 1), float(chunk)))
    begun.finish("ended early", keep_stream=True)
    continued = Recording(COLUMNS, folder, continued=6)
    continued.append(np.array([6.0, 7.0]), np.full((2, 1), 9.0))
    assert continued.finish().data[:, 0].tolist() == [0, 0, 0, 0, 1, 1, 9, 9]
    assert not (folder / "rows.arrows").exists()
    with pytest.raises(RecordingError, match="lacks 3 of the 3 rows"):
        Recording(COLUMNS, folder, continued=3)
