"""A small system around the hostile FMU, and what is left behind by a run of it."""

from __future__ import annotations

import os
from pathlib import Path

from harness.bench import Bench
from tests.hostile.build import hostile_fmu


def bench(folder: Path, *behaviours: str, stop_time: float = 1.0, fmi: int = 3) -> Bench:
    """Noise into the lag, a delayed controller around it, and noise on what is measured."""
    made = Bench(stop_time=stop_time, step=0.01, seed=7)
    made.fmu("plant", hostile_fmu(folder, *behaviours, fmi=fmi))
    made.signal("reference", "low_pass_noise", std=1.0, bandwidth=2.0)
    made.controller("controller", "pid", kp=0.5, ki=1.0)
    made.connect("reference", "controller.reference")
    made.connect("plant.y", "controller.measured", noise={"std": 0.01}, delay=0.025)
    made.connect("controller.u", "plant.u", delay=0.01)
    return made


def children() -> list[int]:
    """Processes that this process has started and not yet waited for."""
    return [int(p) for p in Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()]


def litter(before: set[str], where: Path) -> set[str]:
    """What is in a temporary folder now and was not there before."""
    return {one.name for one in where.iterdir()} - before
