"""Whatever an FMU does in whatever phase, its run ends in one sentence with its rows kept, and the
caller, no process and no temporary file but its own are left."""

import os
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from harness.errors import SimulationError
from harness.process.limits import Limits
from tests.hostile.build import library
from tests.hostile.worlds import bench, children, litter

DEADLY = [
    ("DoStep segfault 50", "doStep by 10 ms at t = 0.5 s crashed with SIGSEGV", 51),
    ("DoStep abort 50", "doStep by 10 ms at t = 0.5 s crashed with SIGABRT", 51),
    ("DoStep exit 50", r"doStep by 10 ms at t = 0.5 s ended the process as by exit\(0\)", 51),
    ("DoStep _exit 50 3", r"doStep by 10 ms at t = 0.5 s ended the process as by exit\(3\)", 51),
    ("DoStep overflow 50", "doStep by 10 ms at t = 0.5 s crashed with SIGSEGV", 51),
    ("DoStep killed 50", "doStep by 10 ms at t = 0.5 s crashed with SIGKILL", 51),
    ("GetFloat64 divide 50", "getting y at t = 0.4.* s crashed with SIGFPE", None),
    ("SetFloat64 illegal 50", "setting u at t = 0.4.* s crashed with SIGILL", None),
    ("load segfault", "loading its library crashed with SIGSEGV", 0),
    ("InstantiateCoSimulation exit", r"fmi3Instantiate ended the process as by exit\(0\)", 0),
    ("EnterInitializationMode abort", "fmi3EnterInitializationMode crashed with SIGABRT", 0),
    ("ExitInitializationMode bus", "fmi3ExitInitializationMode .*crashed with SIGBUS", 0),
    ("Terminate segfault", "fmi3Terminate at t = 1 s crashed with SIGSEGV", 101),
    ("FreeInstance segfault", "fmi3FreeInstance at t = 1 s crashed with SIGSEGV", 101),
    ("unload segfault", "unloading the library at t = 1 s crashed with SIGSEGV", 101),
]
HANGING = [
    ("DoStep hang 50", "doStep by 10 ms at t = 0.5 s had not returned after 0.3 s", 51),
    ("DoStep spin 50", "doStep by 10 ms at t = 0.5 s had not returned after 0.3 s", 51),
    ("DoStep stop 50", "doStep by 10 ms at t = 0.5 s had not returned after 0.3 s", 51),
    ("load hang", "loading its library had not returned after 0.3 s", 0),
    ("EnterInitializationMode hang", "fmi3EnterInitializationMode had not returned", 0),
    ("FreeInstance hang", "fmi3FreeInstance at t = 1 s had not returned after 0.3 s", 101),
]


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    library(3)  # which has a temporary folder of its own
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.mark.parametrize(("behaviour", "words", "rows"), [*DEADLY, *HANGING])
def test_sentence_rows_and_nothing_left(
    tmp_path: Path, temporary: Path, behaviour: str, words: str, rows: int | None
) -> None:
    made, before = bench(tmp_path, behaviour), children()
    with pytest.raises(SimulationError, match=words) as caught:
        made.run(tmp_path / "run", limits=Limits(call=0.3))
    told, result = str(caught.value), caught.value.result
    assert "\n" not in told and "hostile" in told
    assert len(result.time) == rows or rows is None
    assert np.array_equal(result.time, np.arange(len(result.time)) / 100)
    assert result.status.state == "incomplete" and result.status.reason in told
    assert children() == before and litter(set(), temporary) == set()


def test_memory_has_a_limit(tmp_path: Path, temporary: Path) -> None:
    limit = Limits(memory=700 * 2**20)
    with pytest.raises(SimulationError, match=r"doStep.*more than its limit of 700 MiB"):
        bench(tmp_path, "DoStep memory 50").run(limits=limit)


def test_what_the_caller_holds_is_not_the_run_s(tmp_path: Path) -> None:
    ballast = bytearray(os.urandom(2**20)) * 900
    result = bench(tmp_path).run(limits=Limits(memory=700 * 2**20))
    assert len(result.time) > 5 and len(ballast) > 700 * 2**20


def test_a_run_has_a_limit(tmp_path: Path) -> None:
    with pytest.raises(SimulationError, match=r"had not ended after 0\.4 s.*--run-timeout"):
        bench(tmp_path, "DoStep sleep 0 20").run(limits=Limits(run=0.4))


def test_what_the_fmu_said_last_is_told(tmp_path: Path) -> None:
    made = bench(tmp_path, "DoStep log 3", "DoStep abort 4")
    with pytest.raises(SimulationError, match=r"last messages: .*plant: the valve sticks$"):
        made.run()


def test_what_an_fmu_starts_ends_with_it(tmp_path: Path, temporary: Path) -> None:
    made = bench(tmp_path, "DoStep child 3", "DoStep segfault 10")
    with pytest.raises(SimulationError, match="crashed with SIGSEGV"):
        made.run()
    deadline = time.monotonic() + 5.0  # a killed process takes a moment to be gone
    while users(temporary) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert users(temporary) == set()


def users(folder: Path) -> set[str]:
    """Processes that have a file below `folder` in memory, as forked ones have the library."""
    found = set()
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if str(folder) in (process / "maps").read_text(encoding="utf-8", errors="replace"):
                found.add(process.name)
    return found
