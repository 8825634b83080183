"""Resumed from any checkpoint, a run has the rows of one that did not crash, bit by bit: with FMUs
that drive each other under each algorithm, delays of part of a sample, several rates, and noise."""

from pathlib import Path

import numpy as np
import pytest

from harness.bench import Bench
from harness.errors import SimulationError
from harness.process.checkpoint import CHECKPOINT_FILE, Snapshot
from harness.process.limits import Limits
from harness.results.recording import read_recording
from tests.hostile.build import hostile_fmu

EVERY = Limits(checkpoint=None, checkpoint_simulated=0.5)
STEPS = 1000


def bench(folder: Path, *behaviours: str, algorithm: str, linear: bool) -> Bench:
    """Two lags that drive each other, one of them controlled with delays at a slower rate."""
    delays = (0.01, 0.02) if linear else (0.0125, 0.005)  # linear wires need even steps
    made = Bench(stop_time=0.01 * STEPS, step=0.01, seed=11, algorithm=algorithm)
    made.fmu("fast", hostile_fmu(folder, *behaviours, name="fast"), start_values={"T": 0.05})
    made.fmu("slow", hostile_fmu(folder, name="slow"), start_values={"T": 0.4})
    made.signal("wind", "low_pass_noise", std=1.0, bandwidth=3.0)
    made.signal("reference", "white_noise", step=0.1, std=1.0)
    made.controller("controller", "pid", sample_time=0.02, kp=0.5, ki=1.0, kd=0.01)
    made.connect("fast.y", "slow.u", factor=1.5, extrapolation=int(linear))
    made.connect("slow.y", "fast.u", factor=-2.0, extrapolation=int(linear))
    made.connect("wind", "slow.load")
    made.connect("reference", "controller.reference")
    made.connect("slow.y", "controller.measured", noise={"std": 0.01}, delay=delays[0])
    made.connect("controller.u", "fast.load", delay=delays[1])
    return made


def crashing_and_sound(folder: Path, calls: int, **kind: object) -> tuple[Bench, Bench]:
    """One that crashes after so many steps of its process, and one that does not."""
    crash = f"DoStep segfault {calls}"
    return bench(folder / "a", crash, **kind), bench(folder / "b", **kind)  # type: ignore[arg-type]


@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize(
    ("algorithm", "calls"), [("jacobi", 400), ("gauss-seidel", 400), ("iterative", 1500)]
)
def test_coupled(tmp_path: Path, algorithm: str, linear: bool, calls: int) -> None:
    broken, sound = crashing_and_sound(tmp_path, calls, algorithm=algorithm, linear=linear)
    whole = sound.run(tmp_path / "whole")
    assert np.abs(whole["fast.y"]).max() > 0.1 and np.unique(whole["slow.y"]).size > 900
    starts = []
    with pytest.raises(SimulationError, match="crashed with SIGSEGV"):
        broken.run(tmp_path / "run", limits=EVERY)
    while read_recording(tmp_path / "run").status.state == "incomplete":
        starts.append(Snapshot.from_bytes((tmp_path / "run" / CHECKPOINT_FILE).read_bytes()))
        try:
            broken.run(tmp_path / "run", limits=EVERY, resume=True)
        except SimulationError:
            assert len(starts) < 20
    assert all(one.now_ns % 500_000_000 >= 490_000_000 for one in starts)
    assert len(starts) > 1
    one, other = (tmp_path / name / "results.csv" for name in ("run", "whole"))
    assert one.read_bytes() == other.read_bytes()
