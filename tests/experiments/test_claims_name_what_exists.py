"""Every claim of every paper names an experiment, a variant and a metric that there is.

Judging takes minutes of runs; a misspelt name must not wait for them.
"""

from pathlib import Path

import pytest

from harness.experiment.claims import ClaimsSpec, Place, load_claims
from harness.experiment.evidence import REGION
from harness.experiment.experiment import Experiment
from harness.experiment.measures import MEASURED
from harness.results.step_response import metric_units

FOLDER = Path(__file__).parents[2] / "experiments"
FILES = sorted(FOLDER.glob("*/claims.toml"))
OF_A_LOOP = {*metric_units("", ""), "lost_loop", *(f"measured_{name}" for name in MEASURED)}


def places(claims: ClaimsSpec) -> list[tuple[str, Place]]:
    """Whatever a claim's test or condition looks at, with the claim's id."""
    tests = [
        (claim.id, test)
        for claim in claims.claims
        for criterion in claim.criteria
        for test in claims.readings_of(criterion).values()
    ]
    return [(i, place) for i, test in tests for place in (test.own, test.other)]


def known(experiment: Experiment, place: Place) -> bool:
    """Whether a run of the variant, or a sweep, has the metric."""
    spec = experiment.variant_spec(place.variant)
    if place.metric == REGION:
        return experiment.spec.sweep is not None
    return place.metric in spec.metrics or (spec.measure is not None and place.metric in OF_A_LOOP)


def test_there_are_five_papers() -> None:
    assert {path.parent.name for path in FILES} == {
        "ahn2009", "barragan", "raheem2013", "serkies2013", "takata"
    }  # fmt: skip


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.parent.name)
def test_names(path: Path) -> None:
    claims = load_claims(path)
    experiments = {file.stem: Experiment.load(file) for file in path.parent.glob("*.toml")
                   if file != path}  # fmt: skip
    for claim, place in places(claims):
        assert place.experiment in experiments, (claim, place)
        assert place.variant in experiments[place.experiment].variants, (claim, place)
        assert known(experiments[place.experiment], place), (claim, place)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.parent.name)
def test_each_condition_has_a_reason(path: Path) -> None:
    claims = load_claims(path).claims
    assert all(claim.reason for claim in claims if claim.given is not None)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.parent.name)
def test_what_is_compared_was_run_with_the_same_seeds(path: Path) -> None:
    for claim in load_claims(path).claims:
        for test in claim.criteria:
            if test.own.experiment == test.other.experiment:
                continue
            own, other = (
                Experiment.load(path.parent / f"{place.experiment}.toml").spec
                for place in (test.own, test.other)
            )
            if test.metric == REGION:
                assert own.sweep is not None and other.sweep is not None
                assert (own.sweep.x, own.sweep.y) == (other.sweep.x, other.sweep.y), claim.id
            else:
                assert own.study is not None and other.study is not None
                assert (own.seed, own.study.seeds) == (other.seed, other.study.seeds), claim.id
