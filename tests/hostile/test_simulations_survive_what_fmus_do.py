"""`simulate` and `verify` end in one sentence with exit code 1, whatever the FMU does in whatever
phase; rows are kept, and no process and no temporary file is left."""

import json
import signal
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from harness.export.certificate import MEMBER
from tests.hostile.build import hostile_fmu, library
from tests.hostile.worlds import children, litter

PHASES = {
    "load": ("loading its library", 0),
    "InstantiateCoSimulation": ("fmi3Instantiate", 0),
    "EnterInitializationMode": ("fmi3EnterInitializationMode", 0),
    "DoStep": ("doStep by 10 ms at t = 0.05 s", 6),
    "Terminate": ("fmi3Terminate at t = 0.1 s", 11),
    "FreeInstance": ("fmi3FreeInstance at t = 0.1 s", 11),
    "unload": ("unloading the library at t = 0.1 s", 11),
}
ENDS = {
    "segfault": "crashed with SIGSEGV", "exit": "ended the process as by exit(0)",
    "hang": "had not returned after 0.3 s and was ended",
}  # fmt: skip
CASES = [(phase, action) for phase in PHASES for action in ENDS]
CERTIFICATE = {
    "model": "hostile", "reference": "zeros", "step": 0.01, "inputs": {"u": [0.0] * 10},
    "outputs": {"y": [0.0] * 10}, "difference": {"y": 0.0}, "tolerance": 1e-9, "made_with": {},
    "format": 1,
}  # fmt: skip
SIMULATE = ("--stop-time", "0.1", "--step-size", "0.01")


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    library(3)  # which has a temporary folder of its own
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def command(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> tuple[int, str]:
    code = run_command_line(list(map(str, arguments)))
    told = capsys.readouterr().err
    assert "Traceback" not in told
    return code, told


def certified(folder: Path, *behaviours: str) -> Path:
    path = hostile_fmu(folder, *behaviours)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(MEMBER, json.dumps(CERTIFICATE))
    return path


def late(phase: str, action: str) -> str:
    return f"{phase} {action} 5" if phase == "DoStep" else f"{phase} {action}"


@pytest.mark.parametrize(("phase", "action"), CASES)
def test_simulate(
    tmp_path: Path, temporary: Path, capsys: pytest.CaptureFixture[str], phase: str, action: str
) -> None:
    path, out = hostile_fmu(tmp_path, late(phase, action)), tmp_path / "out.csv"
    before, (place, rows) = children(), PHASES[phase]
    options = (*SIMULATE, "--call-timeout", "0.3", "--output-file", out)
    code, told = command(capsys, "simulate", path, *options)
    assert (code == 1 and place.partition("|")[2]) or place in told
    assert ENDS[action] in told and f"({path})" in told
    if rows:
        assert len(out.read_text().splitlines()) == 1 + rows
        assert f"{rows} rows until t = {0.05 if rows == 6 else 0.1} s are in {out}" in told
    assert children() == before and litter(set(), temporary) == set()


@pytest.mark.parametrize(("phase", "action"), CASES)
def test_verify(
    tmp_path: Path, temporary: Path, capsys: pytest.CaptureFixture[str], phase: str, action: str
) -> None:
    path, before = certified(tmp_path, late(phase, action)), children()
    code, told = command(capsys, "verify", path, "--call-timeout", "0.3")
    assert code == 1 and ENDS[action] in told and f"({path})" in told
    assert children() == before and litter(set(), temporary) == set()


def test_memory_and_time_have_limits(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = certified(tmp_path, "DoStep memory 5")
    for arguments in (("simulate", path, *SIMULATE), ("verify", path)):
        code, told = command(capsys, *arguments, "--memory-limit", "500 MB")
        assert code == 1 and "t = 0.05 s was ended because the run held" in told
        assert "doStep by 10 ms" in told or "fmi3DoStep" in told
    path = certified(tmp_path, "DoStep sleep 0 50")
    for arguments in (("simulate", path, *SIMULATE), ("verify", path)):
        code, told = command(capsys, *arguments, "--run-timeout", "0.3")
        assert code == 1 and "the run had not ended after 0.3 s" in told
    assert command(capsys, "simulate", path, "--memory-limit", "much")[0] == 2


def test_nan_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = certified(tmp_path, "GetFloat64 nan 7")
    code, told = command(capsys, "simulate", path, *SIMULATE)
    assert code == 1 and "y is nan at t = 0.06 s, the first of 5 such rows; --allow-n" in told
    assert "11 rows until t = 0.1 s were computed" in told
    assert command(capsys, "simulate", path, *SIMULATE, "--allow-not-finite")[0] == 0
    code, told = command(capsys, "verify", path)
    assert code == 1 and "y differ" in told


def test_what_the_fmu_said_last_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = hostile_fmu(tmp_path, "DoStep log 3", "DoStep abort 4")
    code, told = command(capsys, "simulate", path, *SIMULATE)
    assert (
        code == 1
        and "crashed with SIGABRT (it gave up); last messages: hostile: the valve st" in told
    )
    assert "5 rows until t = 0.04 s were computed; --output-file FILE keeps them" in told


def test_isolated_fmus_write_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = certified(tmp_path, "DoStep litter")
    for arguments in (["simulate", str(path), *SIMULATE], ["verify", str(path)]):
        assert run_command_line([*arguments, "--isolate"]) == 0
        assert not (tmp_path / "litter.txt").exists()
    assert run_command_line(["simulate", str(path), *SIMULATE]) == 0
    assert (tmp_path / "litter.txt").exists()


def test_ctrl_c_ends_a_hang_and_keeps_the_rows(tmp_path: Path) -> None:
    path, out = hostile_fmu(tmp_path, "DoStep print 4", "DoStep hang 5"), tmp_path / "out.csv"
    main = "from harness.cli.main import main; main()"
    process = subprocess.Popen(
        [sys.executable, "-c", main, "simulate", str(path), *SIMULATE, "--output-file", str(out)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=Path(__file__).parents[2],
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    assert process.stdout is not None
    while "the FMU prints" not in process.stdout.readline():
        assert process.poll() is None
    time.sleep(0.2)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    told = process.communicate()[1]
    assert time.monotonic() - began < 3.0  # below one on a machine that is not busy
    assert process.returncode == 1 and "error: interrupted by Ctrl-C at t = 0.05 s" in told
    assert len(out.read_text().splitlines()) == 7
