"""A signal wired to a tunable parameter changes the servo during the run, and nothing else."""

from pathlib import Path

import numpy as np
import pytest

from harness.experiment.experiment import Experiment

FOLDER = Path(__file__).parents[2] / "experiments/raheem2013"
AREA, STIFFNESS = 3.2673e-4, 16010.0
QUIET = {
    "components": {
        "current_error": {"parameters": {"std": 0.0}},
        "load_force": {"parameters": {"std": 0.0}},
    }
}


def test_an_unchanged_servo_is_the_nominal_one_to_the_bit() -> None:
    result = Experiment.load(FOLDER / "figure_8.toml", {"stop_time": 1.2}).run("unchanged")
    ratios = {name: v for name, v in result.metrics.items() if name.endswith("_ratio")}
    assert ratios == dict.fromkeys(ratios, 1.0)
    assert len(ratios) == 4
    assert np.array_equal(result["error.load_pressure"], result["nominal_error.load_pressure"])


def test_the_spring_is_twice_as_stiff_from_the_instant_on() -> None:
    """Without noise and motion, A·P_L = k·x + F·v."""
    result = Experiment.load(FOLDER / "figure_8.toml", QUIET).run("worst_matched")
    force = AREA * result["plant.load_pressure"] - 60.0 * result["plant.velocity"]
    stiffness = force[1:] / result["plant.position"][1:]
    before = (result.time[1:] > 0.5) & (result.time[1:] <= 0.95)
    after = result.time[1:] > 1.5
    np.testing.assert_allclose(stiffness[before], STIFFNESS, rtol=2e-3)
    np.testing.assert_allclose(stiffness[after], 2 * STIFFNESS, rtol=2e-3)


def test_the_spool_closes_four_times_as_slowly() -> None:
    result = Experiment.load(FOLDER / "figure_10.toml", QUIET).run("matched")
    spool = dict(zip(np.round(result.time, 3), result["plant.spool_position"], strict=True))
    assert spool[1.03] / spool[0.95] == pytest.approx(np.exp(-0.08 / 0.04), rel=1e-5)


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*_*.toml")), ids=lambda path: path.stem)
def test_every_variant_can_be_assembled(path: Path) -> None:
    experiment = Experiment.load(path)
    for variant in experiment.variants:
        experiment.bench(variant).system()
