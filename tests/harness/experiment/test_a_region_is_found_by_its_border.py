"""A sweep with a spacing runs the border of a region, and gives the region of the whole grid."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.errors import ExperimentError
from harness.experiment.border import explore
from harness.experiment.sweep import run_sweep
from tests.harness.experiment.loops import MACHINE, load

Place = tuple[int, int]


class Disc:
    """Points on a grid whose distance to a centre is the outcome; it counts what is run."""

    def __init__(self, *centres: tuple[float, float]) -> None:
        self.centres, self.runs = centres, 0

    def __call__(self, places: Sequence[Place], done: float) -> np.ndarray:
        assert 0.0 <= done < 1.0 and places == sorted(places) and len(set(places)) == len(places)
        self.runs += len(places)
        return np.array([[np.hypot(i - a, j - b) for i, j in places] for a, b in self.centres])


@given(
    centre=st.tuples(st.floats(-10, 74), st.floats(-10, 42)),
    other=st.tuples(st.floats(-10, 74), st.floats(-10, 42)),
    radius=st.floats(8.0, 40.0),
    spacing=st.sampled_from([1, 2, 4, 8]),
)
def test_of_discs_wider_than_two_squares(
    centre: tuple[float, float], other: tuple[float, float], radius: float, spacing: int
) -> None:
    shape = (65, 33)
    outcome, ran = explore(shape, spacing, Disc(centre, other), lambda values: values < radius)
    everywhere = [(i, j) for i in range(shape[0]) for j in range(shape[1])]
    whole = Disc(centre, other)(everywhere, 0.0).reshape(2, *shape)
    np.testing.assert_array_equal(outcome < radius, whole < radius)
    np.testing.assert_array_equal(outcome[:, ran], whole[:, ran])


def test_the_work_grows_as_the_border_not_as_the_area() -> None:
    runs = []
    for count in (65, 129, 257):
        disc = Disc((count / 2, count / 3))
        explore((count, count), 8, disc, lambda values, r=count / 4: values < r)
        runs.append(disc.runs - (count // 8 + 1) ** 2)
    assert runs[1] < 2.3 * runs[0] and runs[2] < 2.3 * runs[1] and runs[2] < 257**2 / 6


def test_a_grid_on_one_side_runs_its_coarse_points_only() -> None:
    disc = Disc((0.0, 0.0))
    outcome, ran = explore((17, 9), 4, disc, lambda values: values < 100.0)
    assert disc.runs == ran.sum() == 5 * 3 and np.all(outcome < 100.0)


@pytest.mark.parametrize(("limit", "runs"), [("1.0", range(16, 46)), ("100.0", range(15, 16))])
def test_a_sweep_takes_it_from_its_file(tmp_path: Path, limit: str, runs: range) -> None:
    text = MACHINE.replace("own_seeds = true", "own_seeds = false")
    text = text.replace("count = 3", "count = 9").replace("count = 2", "count = 5")
    text = text.replace("below = 1.0", f"below = {limit}")
    whole = run_sweep(load(tmp_path, text), ("heavy",))["heavy"]
    found = run_sweep(load(tmp_path, text, "sweep.spacing=2"), ("heavy",))["heavy"]
    np.testing.assert_array_equal(found.inside, whole.inside)
    assert found.ran is not None and found.ran.sum() in runs
    np.testing.assert_array_equal(found.outcome[found.ran], whole.outcome[found.ran])


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ("sweep.spacing=3", r"spacing 3 must be a power of 2 .* \(2 and 1\)"),
        ("sweep.spacing=2", r"spacing 2 must .* divides both counts less one"),
        ("sweep.x.count=5", r"with own_seeds a point says nothing of its neighbours"),
    ],
)
def test_a_spacing_that_does_not_fit(tmp_path: Path, change: str, sentence: str) -> None:
    more = ("sweep.spacing=2", "sweep.y.count=3") if "count" in change else ()
    with pytest.raises(ExperimentError, match=sentence):
        load(tmp_path, MACHINE, change, *more)
