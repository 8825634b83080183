"""Each point of a sweep is a run of the experiment with two settings changed."""

from pathlib import Path

import numpy as np
import pytest

from harness.errors import ExperimentError
from harness.experiment.sweep import run_sweep, write_sweep
from tests.harness.experiment.loops import MACHINE, load

X = "components.plant.start_values.angle_deviation"
SPEED = "components.plant.start_values.speed"


def outcomes(folder: Path, text: str, own_seeds: bool, variant: str) -> np.ndarray:
    """The same points one by one, from files that say so."""
    sweep = load(folder, text).spec.sweep
    assert sweep is not None
    found = []
    for i, y in enumerate(sweep.y.values):
        for j, x in enumerate(sweep.x.values):
            seed = 3 + (i * sweep.x.count + j if own_seeds else 0)
            moved = load(folder, text, f"{sweep.x.key}={x!r}", f"{sweep.y.key}={y!r}")
            found.append(moved.run(variant, seed=seed).metrics["distance"])
    return np.array(found, dtype=float).reshape(sweep.y.count, sweep.x.count)


@pytest.mark.parametrize("own_seeds", [True, False])
def test_start_values_of_an_fmu(tmp_path: Path, own_seeds: bool) -> None:
    text = MACHINE.replace("own_seeds = true", f"own_seeds = {str(own_seeds).lower()}")
    regions = run_sweep(load(tmp_path, text))
    assert set(regions) == {"light", "heavy"}
    for variant, region in regions.items():
        expected = outcomes(tmp_path, text, own_seeds, variant)
        assert region.outcome.tobytes() == expected.tobytes()
        assert region.share == np.mean(expected < 1.0)
    assert not np.array_equal(regions["light"].outcome, regions["heavy"].outcome)


def test_other_settings_along_a_row_and_along_a_column(tmp_path: Path) -> None:
    for key, span in ((X, "from = -0.5\nto = 0.5"), (SPEED, "from = -1.0\nto = 4.0")):
        text = MACHINE.replace(f'key = "{key}"', 'key = "stop_time"')
        text = text.replace(span, "from = 0.2\nto = 0.4")
        region = run_sweep(load(tmp_path, text), ("light",))["light"]
        assert region.outcome.tobytes() == outcomes(tmp_path, text, True, "light").tobytes()


def test_a_point_that_ends_early_is_outside(tmp_path: Path) -> None:
    text = MACHINE.replace("from = -1.0\nto = 4.0", "from = 0.5\nto = 1e308")
    region = run_sweep(load(tmp_path, text), ("light",))["light"]
    assert np.isfinite(region.outcome[0]).all() and np.isnan(region.outcome[1]).all()
    assert not region.inside[1].any() and region.share <= 0.5


def test_an_outcome_that_is_no_metric(tmp_path: Path) -> None:
    text = MACHINE.replace('outcome = "distance"', 'outcome = "distanc"')
    with pytest.raises(ExperimentError, match=r"outcome 'distanc' is no metric; .*'distance'"):
        run_sweep(load(tmp_path, text))


def test_what_is_written(tmp_path: Path) -> None:
    experiment = load(tmp_path, MACHINE)
    regions = run_sweep(experiment)
    picture, table = write_sweep(experiment, regions, tmp_path / "out")
    assert picture.stat().st_size > 5000
    heading, *rows = table.read_text(encoding="utf-8").splitlines()
    assert heading == "variant,x,y,outcome,inside,ran" and len(rows) == 2 * 6
    variant, x, y, outcome, inside, ran = rows[7].split(",")
    assert ran == "1"
    region = regions["heavy"]
    assert (variant, float(x), float(y)) == ("heavy", 0.0, -1.0)
    assert float(outcome) == region.outcome[0, 1] and bool(int(inside)) == region.inside[0, 1]


def test_the_fast_grid_is_the_declared_one(tmp_path: Path) -> None:
    fast = load(tmp_path, MACHINE).fast()
    assert fast.spec.sweep is not None
    assert (fast.spec.sweep.x.count, fast.spec.sweep.y.count) == (2, 2)
    assert run_sweep(fast)["light"].outcome.shape == (2, 2)
    plain = load(tmp_path, MACHINE.partition("[sweep.fast]")[0])
    assert plain.fast() is plain
