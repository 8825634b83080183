"""`fmu-harness run` ends with code 1 and one sentence, on Ctrl-C at once; `resume` goes on."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from harness.results.recording import read_recording
from tests.hostile.build import hostile_fmu

FILE = """
title = "one hostile plant"
stop_time = 3.0
step = 0.01
[components.plant]
fmu = "hostile.fmu"
[components.reference]
signal = "white_noise"
parameters = { std = 1.0 }
[connections]
"plant.u" = "reference.value"
[checkpoint]
every = 0.05
"""
COMMAND = "from harness.cli.main import main; main()"


def write(folder: Path, *behaviours: str) -> Path:
    hostile_fmu(folder, *behaviours)
    (folder / "hostile.toml").write_text(FILE)
    return folder / "hostile.toml"


def run(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> tuple[int, str]:
    code = run_command_line(list(map(str, arguments)))
    return code, capsys.readouterr().err


def started(file: Path, out: Path) -> subprocess.Popen[str]:
    arguments = [sys.executable, "-c", COMMAND, "run", str(file), "--output", str(out)]
    return subprocess.Popen(
        arguments, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        cwd=Path(__file__).parents[2],
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip


def test_limits_are_flags(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = write(tmp_path, "DoStep hang 50"), tmp_path / "out"
    code, told = run(capsys, "run", file, "--output", out, "--call-timeout", "0.3")
    assert code == 1 and "doStep by 10 ms at t = 0.5 s had not returned after 0.3 s" in told
    assert f"rows until t = 0.5 s are in {out / 'run'}" in told and "Traceback" not in told
    code, told = run(capsys, "run", file, "--output", out)
    assert code == 1 and "holds a run already; nothing was changed in it: choose" in told
    code, told = run(capsys, "run", file, "--memory-limit", "much", "--output", tmp_path / "other")
    assert code == 2 and "key limits.memory" in told and "4 GiB" in told


def test_ctrl_c_and_resume(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = write(tmp_path, "DoStep sleep 0 2"), tmp_path / "out"
    process = started(file, out)
    while not (out / "run" / "checkpoint.npz").exists():
        assert process.poll() is None
        time.sleep(0.005)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    told = process.communicate()[1]
    assert time.monotonic() - began < 3.0  # below one on a machine that is not busy
    assert process.returncode == 1 and "error: interrupted by Ctrl-C at t = " in told
    assert f"`fmu-harness resume {out}` goes on" in told and "Traceback" not in told
    kept = read_recording(out / "run")
    assert kept.status.state == "incomplete" and 0 < len(kept.time) < 301
    assert run(capsys, "resume", out)[0] == 0
    assert run(capsys, "run", file, "--output", tmp_path / "whole")[0] == 0
    for name in ("run/results.parquet", "run/results.csv", "metrics.csv"):
        assert (out / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_ctrl_c_in_a_long_recording(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Its rows stay in their stream, since writing them as text would take long."""
    file, out = write(tmp_path), tmp_path / "out"
    file.write_text(FILE.replace("stop_time = 3.0", "stop_time = 1e6") + "[limits]\nrun = 60.0\n")
    process = started(file, out)
    stream = out / "run" / "rows.arrows"
    while not stream.exists() or stream.stat().st_size < 60_000_000:
        assert process.poll() is None
        time.sleep(0.005)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    told = process.communicate()[1]
    assert time.monotonic() - began < 2.0  # below one on a machine that is not busy
    assert process.returncode == 1 and "error: interrupted by Ctrl-C at t = " in told
    assert not (out / "run" / "results.csv").exists()
    kept = read_recording(out / "run")
    assert kept.status.state == "incomplete" and "interrupted" in kept.status.reason
    assert len(kept.time) > 1_000_000 and kept.status.until == kept.time[-1]
