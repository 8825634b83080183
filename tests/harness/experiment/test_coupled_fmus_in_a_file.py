"""An experiment file couples FMUs as the bench does, and the schedule says how."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.coupling_order import monolithic
from harness.errors import ExperimentError
from harness.experiment.experiment import Experiment
from harness.master.opened import opened
from harness.master.run import plan_system
from harness.master.timing import schedule

FILE = """
title = "Coupled oscillator"
stop_time = 0.5
step = 0.005
algorithm = "iterative"
coupling_tolerance = 1e-9

[components.left]
fmu = "fmus.oscillator_left.model:plant"
start_values = { position = 0.1 }

[components.right]
fmu = "fmus.oscillator_right.model:plant"

[connections]
"right.left_position" = { from = "left.position", extrapolation = 1 }
"right.left_velocity" = { from = "left.velocity", extrapolation = 1 }
"left.coupling_force" = { from = "right.coupling_force", extrapolation = 1 }
"""


def load(folder: Path, text: str) -> Experiment:
    path = folder / "coupled.toml"
    path.write_text(text, encoding="utf-8")
    return Experiment.load(path)


def test_its_settings_reach_the_run(tmp_path: Path) -> None:
    """Second order needs all of them: held wires would miss by 3e-3 m."""
    result = load(tmp_path, FILE).bench("run").run()
    exact = monolithic(result.time)
    assert np.abs(result["left.position"] - exact[:, 0]).max() < 1e-4


def test_the_schedule_shows_what_is_repeated(tmp_path: Path) -> None:
    system = load(tmp_path, FILE).bench("run").system()
    with opened(system) as fmus:
        lines = [line for _, line in schedule(plan_system(system, fmus))]
    repeat = next(i for i, line in enumerate(lines) if line.startswith("repeat until"))
    assert lines[repeat - 2 : repeat] == ["save the state of left", "save the state of right"]
    assert "    step left by 5 ms" in lines[repeat:]
    assert all(line.startswith("    ") for line in lines[repeat + 1 :])


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("= 1e-9", "= 0.0", "coupling_tolerance"),
        ('"iterative"', '"iterative"\nalgebraic_loops = "ignore"', "'refuse' or 'solve'"),
        ("extrapolation = 1", "extrapolation = 2", "extrapolation"),
    ],
)
def test_settings_that_cannot_be_meant(tmp_path: Path, before: str, after: str, words: str) -> None:
    with pytest.raises(ExperimentError, match=words):
        load(tmp_path, FILE.replace(before, after, 1)).bench("run")
