"""Studies and sweeps give the same figures from several processes as from this one."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from harness.errors import SimulationError
from harness.experiment.parallel import ONE_THREAD, Workers
from harness.experiment.study import run_study
from harness.experiment.sweep import run_sweep
from tests.harness.experiment.loops import FILE, MACHINE, load
from tests.harness.experiment.tasks import end, setting, square


@pytest.fixture(scope="module")
def two() -> Iterator[Workers]:
    with Workers(2) as workers:
        yield workers


def test_a_study(tmp_path: Path, two: Workers) -> None:
    experiment = load(tmp_path, FILE.replace("seeds = 3", "seeds = 11"))
    shares: list[float] = []
    apart = run_study(experiment, workers=two, progress=shares.append)
    here = run_study(experiment)
    assert apart.runs == here.runs and apart.seeds == here.seeds == tuple(range(5, 16))
    assert shares == sorted(shares) and shares[-1] == 1.0
    assert len({metrics["iae"] for metrics in here.runs["soft"]}) == 11


def test_a_sweep(tmp_path: Path, two: Workers) -> None:
    experiment = load(tmp_path, MACHINE)
    apart, here = run_sweep(experiment, workers=two), run_sweep(experiment)
    for variant in experiment.variants:
        assert apart[variant].outcome.tobytes() == here[variant].outcome.tobytes()


def test_a_process_has_one_thread_for_linear_algebra(
    two: Workers, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(ONE_THREAD[0], raising=False)
    with Workers(2) as workers:
        assert dict(workers.spread(setting, ONE_THREAD)) == dict.fromkeys(ONE_THREAD, "1")
    assert ONE_THREAD[0] not in os.environ
    monkeypatch.setenv(ONE_THREAD[0], "3")
    with Workers(2) as workers:
        assert dict(workers.spread(setting, ONE_THREAD[:1])) == {ONE_THREAD[0]: "3"}


def test_results_come_with_their_tasks_and_faults_reach_the_caller(two: Workers) -> None:
    assert dict(two.spread(square, range(9))) == {n: n * n for n in range(9)}
    with pytest.raises(ValueError, match="negative"):
        list(two.spread(square, [1, 2, -1, 3]))
    assert dict(two.spread(square, [])) == {}


def test_processes_that_die_are_replaced(two: Workers) -> None:
    with pytest.raises(SimulationError, match="a process of the study died"):
        list(two.spread(end, [1, 2, 3]))
    assert dict(two.spread(square, [4, 5])) == {4: 16, 5: 25}
