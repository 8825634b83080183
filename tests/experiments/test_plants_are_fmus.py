"""Every experiment has its plant as an FMU; those that have none look at a map or a benchmark."""

from pathlib import Path

import pytest

from harness.experiment.experiment import Experiment
from harness.experiment.schema import FmuSpec

FOLDER = Path(__file__).parents[2] / "experiments"
FILES = [path for path in sorted(FOLDER.glob("*/*.toml")) if path.name != "claims.toml"]
WITHOUT = {
    "barragan/narendra_parthasarathy",  # a difference equation, which has no der(x)
    "serkies2013/figure_3", "serkies2013/figure_4", "serkies2013/figure_5",  # fuzzy maps
    "takata/figure_1", "takata/figure_2",  # functions of the angle
}  # fmt: skip


def name(path: Path) -> str:
    return f"{path.parent.name}/{path.stem}"


@pytest.mark.parametrize("path", FILES, ids=name)
def test_a_plant_is_an_fmu_in_every_variant(path: Path) -> None:
    experiment = Experiment.load(path)
    for variant in experiment.variants:
        components = experiment.variant_spec(variant).components.values()
        fmus = [one for one in components if isinstance(one, FmuSpec)]
        assert bool(fmus) != (name(path) in WITHOUT), variant


@pytest.mark.parametrize("figure", ["figure_7", "figure_8", "figure_9", "figure_10"])
def test_robustness_is_shown_per_state_over_nominal_for_matched_and_inflated_q(figure: str) -> None:
    experiment = Experiment.load(FOLDER / f"raheem2013/{figure}.toml")
    assert {"matched", "inflated", "position", "position_inflated"} <= set(experiment.variants)
    for state in ("position", "velocity", "pressure", "spool"):
        metric = experiment.spec.metrics[f"{state}_ratio"]
        assert metric.signal == f"error.{metric.signal.partition('.')[2]}"
        assert metric.relative_to == f"nominal_{metric.signal}"
        assert experiment.spec.study is not None
        assert f"{state}_ratio" in experiment.spec.study.metrics
    inflation = [
        experiment.variant_spec("inflated").components[c].parameters["inflation"]  # type: ignore[union-attr]
        for c in ("filter", "nominal_filter")
    ]
    assert inflation == [100.0, 100.0]
