"""Variants differ in what they change and in nothing else: same noise, differences paired."""

from pathlib import Path

import numpy as np
import pytest

from harness.experiment.study import run_study
from tests.harness.experiment.loops import FILE, load


def noise(result) -> np.ndarray:  # type: ignore[no-untyped-def]
    return np.asarray(result["controller.measured"] - result["lag.y"])


def test_variants_merge_table_by_table(tmp_path: Path) -> None:
    experiment = load(tmp_path)
    assert experiment.variants == ("soft", "hard")
    assert experiment.label("soft") == "soft PID" and experiment.label("hard") == "hard"
    soft, hard = (
        experiment.variant_spec(name).components["controller"] for name in ("soft", "hard")
    )
    assert soft.parameters | {"kp": 1.0} == hard.parameters  # type: ignore[union-attr]


def test_settings_change_the_file_before_its_variants(tmp_path: Path) -> None:
    changes = ("components.controller.parameters.ki=3.0", "stop_time=0.5")
    experiment = load(tmp_path, FILE, *changes)
    for name in experiment.variants:
        spec = experiment.variant_spec(name)
        assert spec.stop_time == 0.5
        assert spec.components["controller"].parameters["ki"] == 3.0  # type: ignore[union-attr]


def test_the_same_seed_gives_the_same_bits_and_variants_the_same_noise(tmp_path: Path) -> None:
    experiment = load(tmp_path)
    soft, again, hard = (experiment.run(name) for name in ("soft", "soft", "hard"))
    assert soft.data.tobytes() == again.data.tobytes()
    assert np.allclose(noise(soft), noise(hard), rtol=0, atol=1e-15)
    assert not np.array_equal(soft["controller.u"], hard["controller.u"])
    other = experiment.run("soft", seed=6)
    assert not np.allclose(noise(soft), noise(other), atol=1e-3)
    assert noise(soft).std() == pytest.approx(0.05, rel=0.2)


def test_another_component_leaves_the_noise_as_it_was(tmp_path: Path) -> None:
    extra = '[components.bystander]\nsignal = "white_noise"\nparameters = { std = 1.0 }\n'
    first = load(tmp_path).run("soft")
    second = load(tmp_path, FILE.replace("[components.lag]", extra + "\n[components.lag]")).run(
        "soft"
    )
    assert first["controller.measured"].tobytes() == second["controller.measured"].tobytes()


def test_a_study_pairs_its_differences_by_seed(tmp_path: Path) -> None:
    experiment = load(tmp_path)
    study = run_study(experiment)
    assert study.seeds == (5, 6, 7)
    for name in experiment.variants:
        alone = [experiment.run(name, seed=seed).metrics["iae"] for seed in study.seeds]
        assert study.values(name, "iae") == alone
    pairs = np.subtract(study.values("hard", "iae"), study.values("soft", "iae"))
    difference = study.difference("hard", "iae")
    assert difference.value == pytest.approx(pairs.mean(), rel=1e-12)
    assert difference.low < difference.value < difference.high
    frame = study.frame()
    assert len(frame) == 6 and set(frame["seed"]) == {5, 6, 7}
    assert study.write(tmp_path / "out").read_text().count("\n") == 7


def test_what_a_run_leaves_in_its_folder(tmp_path: Path) -> None:
    import json

    result = load(tmp_path).run("hard", tmp_path / "run")
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert names == {"manifest.json", "results.csv", "results.parquet"}
    manifest = json.loads((tmp_path / "run" / "manifest.json").read_text())
    assert manifest["seeds"] == {"seed": 5}
    assert manifest["experiment"]["variant"] == "hard"
    assert manifest["experiment"]["components"]["controller"]["parameters"]["kp"] == 1.0
    assert len(result.time) == 101 and result.metrics["iae"] is not None
