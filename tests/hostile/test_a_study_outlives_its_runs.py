"""In a study or sweep an FMU that crashes or hangs loses its own run, named with its seed."""

from pathlib import Path

import pytest

from harness.experiment.experiment import Experiment
from harness.experiment.parallel import Workers
from harness.experiment.study import run_study
from harness.experiment.sweep import run_sweep
from tests.hostile.build import hostile_fmu

FILE = """
title = "a study of a plant that may crash"
stop_time = 1.0
step = 0.01
[components.plant]
fmu = "sound.fmu"
[components.reference]
signal = "step"
parameters = { time = 0.1, final = 1.0 }
[connections]
"plant.u" = "reference.value"
[metrics.last]
kind = "final"
signal = "plant.y"
[variants.sound]
[variants.broken]
components.plant.fmu = "hostile.fmu"
[study]
seeds = 3
baseline = "sound"
metrics = ["last"]
[sweep]
outcome = "last"
below = 2.0
x = { key = "components.plant.start_values.T", from = 0.1, to = 0.2, count = 2 }
y = { key = "components.reference.parameters.final", from = 1.0, to = 2.5, count = 2 }
"""


@pytest.fixture
def experiment(tmp_path: Path) -> Experiment:
    hostile_fmu(tmp_path, name="sound")
    hostile_fmu(tmp_path, "DoStep segfault 50")
    path = tmp_path / "study.toml"
    path.write_text(FILE)
    return Experiment.load(path)


def test_study(experiment: Experiment) -> None:
    words = r"broken, seed \d: component plant .*doStep by 10 ms at t = 0.5 s crashed with SIGSEGV"
    with Workers(2) as workers, pytest.warns(UserWarning, match=words):
        found = run_study(experiment, workers=workers)
    assert found.lost("broken").value == 1.0 and found.lost("sound").value == 0.0
    assert all(0.99 < metrics["last"] < 1.0 for metrics in found.runs["sound"])


@pytest.mark.parametrize(
    ("behaviour", "limits", "words"),
    [
        ("hang 50", {"call": 0.5}, "doStep by 10 ms at t = 0.5 s had not returned after 0.5 s"),
        ("sleep 0 20", {"run": 0.6}, "the run had not ended after 0.6 s"),
        ("memory 50", {"memory": "700 MiB"}, "more than its limit of 700 MiB"),
    ],
)
def test_study_within_the_limits_of_its_file(
    experiment: Experiment, tmp_path: Path, behaviour: str, limits: dict[str, object], words: str
) -> None:
    hostile_fmu(tmp_path, f"DoStep {behaviour}")
    limited = Experiment.load(experiment.path, {"limits": limits})
    with pytest.warns(UserWarning) as told:
        found = run_study(limited)
    assert len(told) == 3 and all(words in str(one.message) for one in told)
    assert found.lost("broken").value == 1.0 and found.lost("sound").value == 0.0


def test_sweep(experiment: Experiment) -> None:
    with Workers(2) as workers, pytest.warns(UserWarning, match="crashed with SIGSEGV"):
        regions = run_sweep(experiment, workers=workers)
    assert regions["broken"].share == 0.0
    assert regions["sound"].inside.tolist() == [[True, True], [False, False]]
