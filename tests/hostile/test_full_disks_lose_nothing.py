"""Where the disk is full or the folder read-only, a command ends with code 1 and one sentence; what
was there before stays, bit by bit, and rows that were written stay readable."""

import subprocess
import sys
from pathlib import Path

import pytest

from harness.experiment.experiment import Experiment
from harness.experiment.study import run_study
from harness.process.isolation import missing
from harness.results.atomic import atomic_write
from harness.results.recording import read_recording
from tests.hostile.test_killed_processes_lose_no_run import write

LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), int(sys.argv[1])))
from harness.cli.main import main
main(sys.argv[2:])
"""
READ_ONLY = """
import sys
from pathlib import Path
from harness.process.isolation import isolate
isolate([Path(sys.argv[1])])
from harness.cli.main import main
main(sys.argv[2:])
"""
MODES = [[], ["--study", "--jobs", "1"], ["--sweep", "--jobs", "1"]]


def command(program: str, *arguments: object) -> str:
    """The one sentence with which the command ends, with code 1."""
    done = subprocess.run(
        [sys.executable, "-c", program, *map(str, arguments)],
        cwd=Path(__file__).parents[2], capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 1 and "Traceback" not in done.stderr, done.stderr
    told = [line for line in done.stderr.splitlines() if "error: " in line]
    assert len(told) == 1, done.stderr
    return told[0]


def content(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_full_while_rows_are_written(tmp_path: Path) -> None:
    file, out = write(tmp_path, 3000.0), tmp_path / "out"
    told = command(LIMITED, 4_000_000, "run", file, "--output", out)
    assert "File too large" in told and str(out) in told
    kept = read_recording(out / "a")
    assert kept.status.state == "incomplete" and 0 < len(kept.time) < 300_001
    assert kept.time.tolist() == [n / 100 for n in range(len(kept.time))]
    assert not [name for name in content(out) if "partial" in name]


@pytest.mark.parametrize(
    ("mode", "partial"), [("--study", ".study.partial.csv"), ("--sweep", ".regions.partial.png")]
)
def test_full_when_results_are_written(tmp_path: Path, mode: str, partial: str) -> None:
    file, out = write(tmp_path, 0.1), tmp_path / "out"
    out.mkdir()
    (out / "older.csv").write_text("older")
    (out / partial).symlink_to("/dev/full")
    told = command(LIMITED, 10**9, "run", file, "--output", out, "--jobs", "1", mode)
    assert "No space left on device" in told and str(out) in told
    left = content(out)
    assert left["older.csv"] == b"older" and left["runs.jsonl"].count(b"\n") >= 2
    assert set(left) == {"older.csv", "runs.jsonl", "experiment.json", "manifest.json"}


@pytest.mark.parametrize("mode", MODES, ids=str)
def test_read_only(tmp_path: Path, mode: list[str]) -> None:
    if any("Landlock, so" in phrase or "Linux only" in phrase for phrase in missing()):
        pytest.skip("folders cannot be made read-only for root here")
    file, scratch = write(tmp_path, 0.1), tmp_path / "scratch"
    scratch.mkdir()
    told = command(READ_ONLY, scratch, "run", file, "--output", tmp_path / "out", *mode)
    assert "cannot" in told and str(tmp_path / "out") in told and "choose another one" in told
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("mode", MODES[:2], ids=str)
def test_twice_into_one_folder(tmp_path: Path, mode: list[str]) -> None:
    file, out = write(tmp_path, 0.1), tmp_path / "out"
    arguments = [sys.executable, "-c", "from harness.cli.main import main; main()", "run"]
    arguments += [str(file), "--output", str(out), *mode]
    subprocess.run(arguments, cwd=Path(__file__).parents[2], check=True, capture_output=True)
    before = content(out)
    assert "already; nothing was changed in it" in command(LIMITED, 10**9, *arguments[3:])
    assert content(out) == before


def test_a_file_in_place_of_which_none_can_be_written_stays(tmp_path: Path) -> None:
    study = run_study(Experiment.load(write(tmp_path, 0.1)))
    path = study.write(tmp_path)
    before = path.read_bytes()
    with pytest.raises(OSError), atomic_write(path) as partial:
        partial.write_bytes(before[:10])
        raise OSError(28, "No space left on device")
    assert path.read_bytes() == before and len(list(tmp_path.glob("*study*"))) == 1
