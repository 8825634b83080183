"""Whatever an FMU does, the command ends with the right code and one sentence; rows survive.

Nothing is left behind: no file in the temporary folder, no worker, and this process lives.
"""

import os
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from harness.bench import Bench
from harness.cli.main import run_command_line
from harness.results.storage import read_recording
from tests.hostile.build import hostile_fmu, library
from tests.hostile.runs import FATAL_RUNS, HARMLESS_RUNS, Run

FILE = """title = "A lag"
stop_time = 0.1
[components.plant]
fmu = "hostile.fmu"
[components.reference]
signal = "step"
parameters = { time = 0.02, final = 1.0 }
[connections]
"plant.u" = "reference.value"
[checkpoint]
every = 0.0
[limits]
"""


@pytest.fixture(scope="module", autouse=True)
def warm(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Workers take over what this process has loaded, which a short deadline has no time for."""
    library(2), library(3)
    bench = Bench(stop_time=0.1)
    bench.fmu("plant", hostile_fmu(tmp_path_factory.mktemp("warm")))
    bench.run(in_process=True)


@pytest.fixture(autouse=True)
def nothing_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    monkeypatch.chdir(folder)
    before = workers()
    yield
    assert [path.name for path in folder.iterdir() if path.name != "litter.txt"] == []
    assert workers() <= before


def workers() -> set[int]:
    """Children of this process, and processes that work in the temporary folder of this test."""
    found = set()
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit() or int(entry.name) == os.getpid():
            continue
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            if parent == os.getpid() or str(Path.cwd()) in str((entry / "cwd").readlink()):
                found.add(int(entry.name))
        except OSError:
            continue
    return found


def run(folder: Path, one: Run, capsys: pytest.CaptureFixture[str]) -> str:
    (folder / "lag.toml").write_text(FILE + one.settings + "\n")
    hostile_fmu(folder, *one.behaviour.splitlines(), fmi=one.fmi)
    code = run_command_line(["run", str(folder / "lag.toml"), "--output", str(folder / "out")])
    shown = capsys.readouterr().err
    assert code == one.code and "Traceback" not in shown, shown
    return shown


@pytest.mark.parametrize("one", FATAL_RUNS, ids=str)
def test_fault(tmp_path: Path, capsys: pytest.CaptureFixture[str], one: Run) -> None:
    shown = run(tmp_path, one, capsys)
    sentences = [line for line in shown.splitlines() if "error: " in line]
    assert len(sentences) == 1 and re.search(one.words, sentences[0]), shown
    result = read_recording(tmp_path / "out" / "run")
    assert one.rows in (None, len(result.time)), len(result.time)
    assert result.status.state == "incomplete"


@pytest.mark.parametrize("one", HARMLESS_RUNS, ids=str)
def test_no_fault(tmp_path: Path, capsys: pytest.CaptureFixture[str], one: Run) -> None:
    assert "error" not in run(tmp_path, one, capsys)
    assert len(read_recording(tmp_path / "out" / "run").time) == one.rows
