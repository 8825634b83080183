"""An experiment without `[measure]` judges no loop: its runs lose none, unless they end early."""

from pathlib import Path

import pytest

from harness.experiment.experiment import Experiment
from harness.experiment.study import LOST, Study

DATA = {
    "title": "no measure",
    "stop_time": 1.0,
    "components": {"s": {"signal": "constant", "parameters": {"value": 1.0}}},
    "variants": {"a": {}},
    "study": {"seeds": 4, "baseline": "a"},
}


@pytest.mark.parametrize(("ended_early", "share"), [(0, 0.0), (1, 0.25), (4, 1.0)])
def test_share_of_lost_loops(ended_early: int, share: float) -> None:
    experiment = Experiment.from_data(DATA, Path("x/no_measure.toml"))
    runs = [{LOST: 1.0}] * ended_early + [{"error": 0.1}] * (4 - ended_early)
    study = Study(experiment, (0, 1, 2, 3), {"a": tuple(runs)})
    assert study.lost("a").share == share
