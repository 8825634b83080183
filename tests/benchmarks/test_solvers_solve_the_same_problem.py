"""The sides of `work_precision` reach the same states, and times are read off at equal error."""

from math import isnan, sqrt
from pathlib import Path

import numpy as np
import pytest

from benchmarks.plant_loops import LOOPS, closed_loop
from benchmarks.solvers import Solvers
from benchmarks.trajectory import STEP
from benchmarks.work_precision import Point, methods, time_at

DRIVE = next(loop for loop in LOOPS if loop.plant.name == "two_mass_drive")


def test_all_solvers_agree(tmp_path: Path) -> None:
    """Each within 1e-5 of the range at a tolerance of 1e-8; the input jumps at every sample."""
    solvers = Solvers.of(DRIVE.plant, tmp_path)
    trajectory = closed_loop(DRIVE, solvers, 12)
    assert np.all(np.diff(trajectory.inputs[:, 0]) != 0.0)
    for name, method in methods(solvers).items():
        run = method(1e-8, STEP, trajectory.inputs)
        assert trajectory.error(run.states).max() <= 1e-5, name
        assert np.all(run.nanoseconds > 0.0), name


def test_times_are_interpolated_on_logarithmic_scales() -> None:
    found = [Point("plant", "method", 0.1, t, e) for t, e in ((1.0, 1e-2), (4.0, 1e-4))]
    assert time_at(found, 1e-3) == pytest.approx(sqrt(1.0 * 4.0))
    assert isnan(time_at(found, 1e-5))
