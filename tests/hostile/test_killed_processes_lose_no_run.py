"""Processes of a sweep or study killed at random times: every run comes once, with its result."""

import os
import random
import signal
from pathlib import Path

import pytest

from harness.experiment.experiment import Experiment
from harness.experiment.parallel import Workers
from harness.experiment.study import run_study
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


@pytest.mark.slow
def test_a_study_has_the_results_of_an_undisturbed_one(tmp_path: Path) -> None:
    hostile_fmu(tmp_path)
    text = FILE.replace("stop_time = 0.1", "stop_time = 5.0").replace("call = 0.3", "")
    text = text.replace('signal = "step"', 'signal = "white_noise"')
    text = text.replace("{ time = 0.02, final = 1.0 }", "{ std = 1.0 }")
    text += '[variants.a]\nseed = 1\n[study]\nseeds = 16\nbaseline = "a"\nmetrics = ["power"]\n'
    text += '[metrics.power]\nkind = "rms"\nsignal = "plant.y"\n'
    (tmp_path / "lag.toml").write_text(text)
    experiment = Experiment.load(tmp_path / "lag.toml")
    calm, killer = run_study(experiment), Killer(2, 0.3)

    def progress(share: float) -> None:
        if 0.1 < share < 0.95:
            killer.maybe()

    with Workers(2) as workers:
        found = run_study(experiment, workers=workers, progress=progress)
    assert found.runs == calm.runs
    assert len({run["power"] for run in calm.runs["a"]}) == 16
    assert killer.killed
