"""A study and a sweep may name the variants that take part, and a sweep the seed of its own."""

from pathlib import Path

import numpy as np
import pytest

from harness.errors import ExperimentError
from harness.experiment.reproduce import reproduce
from harness.experiment.study import run_study
from harness.experiment.sweep import run_sweep
from tests.harness.experiment.loops import FILE, MACHINE, load
from tests.harness.experiment.papers import CLAIMS, paper

ONE = FILE.replace('baseline = "soft"', 'baseline = "hard"\nvariants = ["hard"]')


def test_of_a_study(tmp_path: Path) -> None:
    assert set(run_study(load(tmp_path, ONE)).runs) == {"hard"}
    assert set(run_study(load(tmp_path, ONE), ("soft",)).runs) == {"soft"}


def test_a_baseline_takes_part(tmp_path: Path) -> None:
    with pytest.raises(ExperimentError, match=r"study\.baseline 'soft' takes no part"):
        load(tmp_path, ONE.replace('baseline = "hard"', 'baseline = "soft"'))


def test_of_a_sweep_and_its_least_point(tmp_path: Path) -> None:
    text = MACHINE.replace("own_seeds = true", 'variants = ["light"]')
    regions = run_sweep(load(tmp_path, text))
    assert set(regions) == {"light"}
    region = regions["light"]
    i, j = np.argwhere(region.outcome == region.outcome.min())[0]
    assert region.least == (
        region.spec.x.values[j], region.spec.y.values[i], region.outcome.min()
    )  # fmt: skip


def test_the_seed_of_a_sweep(tmp_path: Path) -> None:
    one, other = (
        run_sweep(load(tmp_path, text), ("light",))["light"].outcome.tobytes()
        for text in (
            MACHINE.replace("own_seeds = true", "seed = 8"),
            MACHINE.replace("own_seeds = true", "").replace("seed = 3", "seed = 8"),
        )
    )
    assert one == other


def test_a_study_alone_has_no_single_runs(tmp_path: Path) -> None:
    alone = paper(tmp_path, CLAIMS)
    path = alone.experiments["lag"]
    path.write_text(FILE.replace("seeds = 3", "seeds = 3\nalone = true"), encoding="utf-8")
    done = reproduce(alone, tmp_path / "out")
    assert done.pictures["lag"] == () and done.evidence["lag"].study is not None
    assert not (tmp_path / "out/lag/soft").exists()
