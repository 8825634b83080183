"""With everything read-only but a temporary folder, and no home, the command runs; machine code is
kept where `FMU_HARNESS_CACHE` says, and damaged code there is made anew."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import harness
from harness.process.isolation import missing
from tests.hostile.build import hostile_fmu
from tests.hostile.test_the_command_line_survives import FILE

COMMAND = """
import sys
from pathlib import Path
from harness.process.isolation import isolate
isolate([Path(sys.argv[1])])
from harness.cli.main import main
main(sys.argv[2:])
"""
NOTE = "note: machine code cannot be kept in"

pytestmark = pytest.mark.skipif(
    any("Landlock, so" in phrase or "Linux only" in phrase for phrase in missing()),
    reason="folders cannot be made read-only for root here",
)


@pytest.fixture(scope="module")
def installation(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the harness without machine code."""
    folder = tmp_path_factory.mktemp("installation")
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(Path(harness.__file__).parent, folder / "harness", ignore=ignored)
    hostile_fmu(folder)
    (folder / "hostile.toml").write_text(FILE.replace("stop_time = 3.0", "stop_time = 0.1"))
    return folder


def run(installation: Path, writable: Path, out: str, *flags: str, **more: str) -> str:
    kept = ("PATH", "LD_LIBRARY_PATH")
    environment = {name: os.environ[name] for name in kept if name in os.environ}
    environment |= {"PYTHONPATH": str(installation), "TMPDIR": str(writable), "HOME": "/nowhere"}
    environment |= {"MPLCONFIGDIR": str(writable), "PYTHONDONTWRITEBYTECODE": "1", **more}
    arguments = ["run", installation / "hostile.toml", "--output", writable / out, *flags]
    done = subprocess.run(
        [sys.executable, "-c", COMMAND, writable, *arguments],
        env=environment, cwd="/", capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert (writable / out / "run" / "results.csv").exists()
    return done.stderr


def test_without_any_cache(installation: Path, tmp_path: Path) -> None:
    told = run(installation, tmp_path, "out", "--isolate")
    assert told.count(NOTE) == 1 and "Traceback" not in told
    assert "set FMU_HARNESS_CACHE to a folder that can be written" in told


def test_with_a_cache_of_our_own(installation: Path, tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    assert "note" not in run(installation, tmp_path, "first", FMU_HARNESS_CACHE=str(cache))
    files = sorted(cache.rglob("*.nb[ci]"))
    assert len(files) >= 6
    times = [file.stat().st_mtime_ns for file in files]
    assert "note" not in run(installation, tmp_path, "second", FMU_HARNESS_CACHE=str(cache))
    assert [file.stat().st_mtime_ns for file in files] == times
    for file in files:
        file.write_bytes(file.read_bytes()[:100])
    assert "note" not in run(installation, tmp_path, "third", FMU_HARNESS_CACHE=str(cache))
    assert all(file.stat().st_size > 100 for file in files if file.suffix == ".nbc")
