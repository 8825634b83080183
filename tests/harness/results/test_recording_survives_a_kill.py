"""After SIGKILL every chunk that was appended is readable, and the run is sealed as incomplete."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from harness.results.recording import read_recording, seal

CHUNKS, ROWS = 5, 100

WRITER = f"""
import os, signal, sys
from pathlib import Path
import numpy as np
from harness.results.recording import Column, Recording
recording = Recording([Column("plant.force", "N"), Column("plant.speed", "m/s")], Path(sys.argv[1]))
for chunk in range({CHUNKS}):
    rows = np.arange(chunk * {ROWS}, (chunk + 1) * {ROWS})
    recording.append(rows / 100, np.column_stack([rows, rows / 3.0]))
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture
def killed(tmp_path: Path) -> Path:
    folder = tmp_path / "run"
    root = Path(__file__).parents[3]
    done = subprocess.run([sys.executable, "-c", WRITER, str(folder)], cwd=root, check=False)
    assert done.returncode == -9
    return folder


def check_rows(data: np.ndarray, rows: int) -> None:
    assert data.shape == (rows, 2)
    assert np.array_equal(data[:, 0], np.arange(rows))
    assert np.array_equal(data[:, 1], np.arange(rows) / 3.0)


def test_the_rows_before_the_kill_are_read(killed: Path) -> None:
    result = read_recording(killed)
    check_rows(result.data, CHUNKS * ROWS)
    assert result.status.state == "incomplete"
    assert result.status.until == 4.99
    assert result.unit("plant.force") == "N"


def test_a_torn_last_chunk_costs_that_chunk_only(killed: Path) -> None:
    stream = killed / "rows.arrows"
    whole = stream.read_bytes()
    for lost in (1, 100, ROWS * 8 * 3):
        stream.write_bytes(whole[:-lost])
        check_rows(read_recording(killed).data, (CHUNKS - 1) * ROWS)
    stream.write_bytes(whole[:10])  # not even the schema
    assert read_recording(killed).data.shape == (0, 2)


def test_sealing_gives_the_files_of_an_incomplete_run(killed: Path) -> None:
    result = seal(killed, reason="the worker died in plant.do_step")
    check_rows(result.data, CHUNKS * ROWS)
    assert str(result.status) == ("incomplete until t = 4.99 s: the worker died in plant.do_step")
    assert not (killed / "rows.arrows").exists()
    assert len((killed / "results.csv").read_text().splitlines()) == CHUNKS * ROWS + 1
    again = seal(killed, reason="asked twice")
    assert again.status == result.status
    check_rows(again.data, CHUNKS * ROWS)
