"""Killed at any moment, worker or supervisor, a run leaves the rows so far readable, no process and
no temporary file; resumed, it becomes the run that was not killed."""

import os
import signal
import tempfile
import time
from contextlib import suppress
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest

from harness.errors import SimulationError
from harness.process.limits import Limits
from harness.results.recording import read_recording
from tests.hostile.worlds import bench, litter

FILES = ("results.parquet", "results.csv")
LIMITS = Limits(checkpoint=0.02)


def run(folder: Path, name: str) -> None:
    with suppress(SimulationError):  # where the worker was killed
        bench(folder, "DoStep sleep 0 1", stop_time=3.0).run(folder / name, limits=LIMITS)


def supervise(folder: Path, name: str) -> None:
    """In a process of its own, which is to be killed."""
    tempfile.tempdir = str(folder / "temporary")
    run(folder, name)


def children(process: int) -> list[int]:
    with suppress(OSError):
        told = Path(f"/proc/{process}/task/{process}/children").read_text()
        return [int(number) for number in told.split()]
    return []


def alive(process: int) -> bool:
    with suppress(OSError):
        return "State:\tZ" not in Path(f"/proc/{process}/status").read_text()
    return False


def kill(folder: Path, name: str, seconds: float, victims: str) -> int:
    """Kill a run so many seconds after it has begun to record; rows that were on disk by then."""
    supervisor = get_context("fork").Process(target=supervise, args=(folder, name))
    supervisor.start()
    assert supervisor.pid is not None
    while not (folder / name / "rows.arrows").exists():
        time.sleep(0.002)
    time.sleep(seconds)
    started = children(supervisor.pid)
    before = len(read_recording(folder / name).time)
    for victim in (*started[1:2], supervisor.pid):  # the first is the janitor
        if victims in ("both", "worker" if victim in started else "supervisor"):
            with suppress(ProcessLookupError):
                os.kill(victim, signal.SIGKILL)
    supervisor.join()
    deadline = time.monotonic() + 10.0
    while any(map(alive, started)) or litter(set(), folder / "temporary"):
        assert time.monotonic() < deadline, "something was left behind"
        time.sleep(0.01)
    return before


def check_kills(folder: Path, times: list[float]) -> None:
    (folder / "temporary").mkdir()
    run(folder, "whole")
    whole = read_recording(folder / "whole")
    for i, seconds in enumerate(times):
        victims = ("worker", "supervisor", "both")[i % 3]
        before = kill(folder, f"{i}", seconds, victims)
        kept = read_recording(folder / f"{i}")
        n = len(kept.time)
        assert np.array_equal(kept.data, whole.data[:n]) and n >= before
        if kept.status.state == "incomplete":
            made = bench(folder, "DoStep sleep 0 1", stop_time=3.0)
            made.run(folder / f"{i}", resume=True)
        for name in FILES:
            assert (folder / f"{i}" / name).read_bytes() == (folder / "whole" / name).read_bytes()


def test_ten_kills(tmp_path: Path) -> None:
    check_kills(tmp_path, np.random.default_rng(1).uniform(0.0, 0.4, 10).tolist())


@pytest.mark.slow
def test_two_hundred_kills(tmp_path: Path) -> None:
    check_kills(tmp_path, np.random.default_rng(2).uniform(0.0, 0.4, 200).tolist())
