"""A recording that cannot be made says why, and leaves what was there before untouched."""

from pathlib import Path

import numpy as np
import pytest

from harness.errors import RecordingError
from harness.results.recording import Column, Recording, read_recording

COLUMNS = (Column("x"), Column("y"))


def test_a_folder_that_holds_something_is_refused_and_kept(tmp_path: Path) -> None:
    (tmp_path / "results.csv").write_text("precious")
    with pytest.raises(RecordingError, match=r"is not empty \(it holds 'results.csv'\)"):
        Recording(COLUMNS, tmp_path)
    assert [one.name for one in tmp_path.iterdir()] == ["results.csv"]
    assert (tmp_path / "results.csv").read_text() == "precious"


def test_an_empty_folder_and_a_missing_one_are_used(tmp_path: Path) -> None:
    Recording(COLUMNS, tmp_path).finish()
    Recording(COLUMNS, tmp_path / "deep" / "er").finish()
    assert (tmp_path / "deep" / "er" / "results.parquet").exists()


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordingError, match=r"cannot make the run folder .*file/run"):
        Recording(COLUMNS, tmp_path / "file" / "run")
    with pytest.raises(RecordingError, match=r"cannot make the run folder .*file"):
        Recording(COLUMNS, tmp_path / "file")


def test_a_full_disk_is_reported(tmp_path: Path) -> None:
    recording = Recording(COLUMNS, tmp_path / "run")

    class Full:
        def write_batch(self, batch: object) -> None:
            raise OSError(28, "No space left on device")

    recording._stream = Full()
    with pytest.raises(RecordingError, match=r"cannot write rows into .*run.*No space left"):
        recording.append(np.zeros(1), np.zeros((1, 2)))


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ((Column("x"), Column("x")), "two recorded columns are called 'x'"),
        ((Column("time"),), "may not be called 'time'"),
    ],
)
def test_column_names(columns: tuple[Column, ...], said: str) -> None:
    with pytest.raises(RecordingError, match=said):
        Recording(columns)


def test_rows_must_fit_and_never_go_back_in_time() -> None:
    recording = Recording(COLUMNS)
    with pytest.raises(RecordingError, match=r"1 rows of 2 columns were expected.*\(1, 3\)"):
        recording.append(np.zeros(1), np.zeros((1, 3)))
    recording.append(np.array([5.0, 5.0]), np.zeros((2, 2)))  # both sides of an event
    for late in ([4.0, 6.0], [5.0, 7.0, 6.0]):
        with pytest.raises(RecordingError, match=r"back in time: [46] s after [57] s"):
            recording.append(np.array(late), np.zeros((len(late), 2)))
    recording.finish()
    with pytest.raises(RecordingError, match="recording that is finished"):
        recording.append(np.array([8.0]), np.zeros((1, 2)))


def test_reading_what_is_no_run_folder(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"is no run folder: it holds no manifest.json"):
        read_recording(tmp_path)
    (tmp_path / "manifest.json").write_text("{")
    with pytest.raises(RecordingError, match="cannot be read as a manifest"):
        read_recording(tmp_path)


def test_an_exception_inside_the_recording_makes_it_incomplete(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), Recording(COLUMNS, tmp_path / "run") as recording:
        recording.append(np.array([0.0, 1.0]), np.zeros((2, 2)))
        1 / 0  # noqa: B018
    status = read_recording(tmp_path / "run").status
    assert str(status) == "incomplete until t = 1 s: ZeroDivisionError: division by zero"
