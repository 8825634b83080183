"""Experiments that measure no loop: no run of theirs is a lost loop, unless it ended early."""

from pathlib import Path

from harness.experiment.experiment import Experiment
from harness.experiment.study import LOST, Study

TEXT = {
    "title": "an estimator",
    "stop_time": 1.0,
    "components": {"a": {"signal": "constant", "parameters": {"value": 1.0}}},
    "study": {"seeds": 2, "baseline": "run"},
}
experiment = Experiment.from_data(TEXT, Path("estimator.toml"))


def lost(*runs: dict[str, float | None]) -> float:
    return Study(experiment, (0, 1), {"run": runs}).lost("run").value


def test_a_run_with_its_metrics_is_kept() -> None:
    assert lost({"error": 0.1}, {"error": None}) == 0.0


def test_a_run_that_ended_early_or_measured_nothing_is_lost() -> None:
    assert lost({LOST: 1.0}, {}) == 1.0
    assert lost({LOST: 0.0, "error": 0.1}, {LOST: 1.0, "error": 9.0}) == 0.5
