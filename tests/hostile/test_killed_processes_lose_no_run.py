"""Processes of a sweep or study killed at random times: every run comes once, with its result."""

import os
import random
import signal
import threading
from contextlib import suppress
from pathlib import Path
from typing import Self

import pytest

from harness.experiment.experiment import Experiment
from harness.experiment.parallel import Workers
from harness.experiment.study import run_study
from harness.experiment.sweep import run_sweep
from tests.hostile.build import hostile_fmu
from tests.hostile.tasks import slow_square, suicide
from tests.hostile.test_runs_end_in_one_sentence import FILE


def pool() -> list[int]:
    """Processes that multiprocessing has spawned for this one to work."""
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            if parent == os.getpid() and b"spawn_main" in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
        except OSError:
            continue
    return sorted(found)


class Killer:
    """Kills a process of the pool with some chance whenever it is asked."""

    def __init__(self, seed: int, chance: float) -> None:
        self.random, self.chance, self.killed = random.Random(seed), chance, 0

    def maybe(self, _: object = None) -> None:
        if self.random.random() < self.chance:
            for victim in self.random.sample(there := pool(), bool(there)):
                os.kill(victim, signal.SIGKILL)
                self.killed += 1


class ClockKiller(Killer, threading.Thread):
    """Kills at random times of the clock, whatever goes on; a context manager."""

    def __init__(self, seed: int, seconds: float) -> None:
        threading.Thread.__init__(self)
        Killer.__init__(self, seed, 1.0)
        self.seconds, self.over = seconds, threading.Event()

    def run(self) -> None:
        while not self.over.wait(self.random.uniform(0.0, 2.0 * self.seconds)):
            with suppress(ProcessLookupError):
                self.maybe()

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.over.set()
        self.join()


def test_every_task_comes_once() -> None:
    killer, pairs = Killer(1, 0.1), []
    with Workers(2) as workers:
        for pair in workers.spread(slow_square, list(range(60)), careful=slow_square):
            pairs.append(pair)
            if len(pairs) < 59:
                killer.maybe()
    assert sorted(pairs) == [(n, n * n) for n in range(60)]
    assert killer.killed > 2


def test_a_task_that_kills_its_process_is_done_with_care() -> None:
    with Workers(2) as workers:
        pairs = list(workers.spread(suicide, list(range(8)), careful=slow_square))
    assert sorted(n for n, _ in pairs) == list(range(8))
    assert dict(pairs)[3] == 9


def write(folder: Path, seconds: float) -> Path:
    """A study and a sweep of runs with noise, so that each has a result of its own."""
    hostile_fmu(folder)
    text = FILE.replace("stop_time = 0.1", f"stop_time = {seconds}").replace("call = 0.3", "")
    text = text.replace('signal = "step"', 'signal = "white_noise"')
    text = text.replace("{ time = 0.02, final = 1.0 }", "{ std = 1.0 }") + TABLES
    (folder / "lag.toml").write_text(text)
    return folder / "lag.toml"


TABLES = """
[variants.a]
seed = 1
[study]
seeds = 16
baseline = "a"
metrics = ["power"]
[metrics.power]
kind = "rms"
signal = "plant.y"
[sweep]
outcome = "power"
below = 0.2
own_seeds = true
x = { key = "components.plant.start_values.T", from = 0.1, to = 0.5, count = 4 }
y = { key = "components.reference.parameters.std", from = 0.5, to = 1.5, count = 12 }
"""


@pytest.mark.slow
def test_a_study_has_the_results_of_an_undisturbed_one(tmp_path: Path) -> None:
    experiment = Experiment.load(write(tmp_path, 5.0))
    calm, killer = run_study(experiment), Killer(2, 0.3)

    def progress(share: float) -> None:
        if 0.1 < share < 0.95:
            killer.maybe()

    with Workers(2) as workers:
        found = run_study(experiment, workers=workers, progress=progress)
    assert found.runs == calm.runs
    assert len({run["power"] for run in calm.runs["a"]}) == 16
    assert killer.killed


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [0.3, 1.0])
def test_a_sweep_has_the_points_of_an_undisturbed_one(tmp_path: Path, seconds: float) -> None:
    """Killed every so many seconds on average, also while processes start."""
    experiment, shares = Experiment.load(write(tmp_path, 1000.0)), []
    calm = run_sweep(experiment)["a"].outcome
    with Workers(2) as workers, ClockKiller(3, seconds) as killer:
        found = run_sweep(experiment, workers=workers, progress=shares.append)["a"].outcome
    assert found.tobytes() == calm.tobytes() and len(set(calm.ravel())) == 48
    assert shares == sorted(set(shares)) and shares[-1] == 1.0
    assert killer.killed
