"""A run of an .ssp, whose files are unpacked while it lasts only, resumes; not with another one."""

import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.hostile.test_the_command_line_survives import COMMAND, run, write

ROOT = Path(__file__).parents[2]


@pytest.fixture
def package(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    target = tmp_path / "hostile.ssp"
    code, told = run(capsys, "export", write(tmp_path, "DoStep sleep 0 2"), "--output", target)
    assert code == 0, told
    return target


@pytest.fixture
def interrupted(package: Path, tmp_path: Path) -> Path:
    """The folder of a run with a setting of its own that Ctrl-C ended after a checkpoint."""
    out = tmp_path / "out"
    words = ["run", str(package), "--set", "seed=7", "--output", str(out)]
    process = subprocess.Popen(
        [sys.executable, "-c", COMMAND, *words], cwd=ROOT,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    while not (out / "run" / "checkpoint.npz").exists():
        assert process.poll() is None
        time.sleep(0.005)
    process.send_signal(signal.SIGINT)
    assert process.wait() == 1
    return out


def test_it_becomes_the_run_that_was_not_interrupted(
    package: Path, interrupted: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, told = run(capsys, "resume", interrupted)
    assert code == 0, told
    whole = tmp_path / "whole"
    assert run(capsys, "run", package, "--set", "seed=7", "--output", whole)[0] == 0
    for name in ("run/results.parquet", "run/results.csv", "metrics.csv"):
        assert (interrupted / name).read_bytes() == (whole / name).read_bytes()


def test_another_package_in_its_place_is_refused(
    package: Path, interrupted: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept = shutil.copyfile(package, tmp_path / "kept")
    assert run(capsys, "export", package, "--set", "seed=8", "--output", package)[0] == 0
    code, told = run(capsys, "resume", interrupted)
    assert code == 1 and f"the package {package} that it runs has changed since" in told
    package.unlink()
    code, told = run(capsys, "resume", interrupted)
    assert code == 1 and "is gone; put the one back" in told and "Traceback" not in told
    shutil.copyfile(kept, package)
    assert run(capsys, "resume", interrupted)[0] == 0
