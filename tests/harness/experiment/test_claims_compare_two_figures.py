"""A claim may compare variants, metrics of one run, and experiments, always seed by seed."""

from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from harness.errors import UsageError
from harness.experiment.claims import CriterionSpec
from harness.experiment.evidence import Evidence, sample_of
from harness.experiment.experiment import Experiment
from harness.experiment.study import LOST, Study
from harness.results.intervals import Estimate
from tests.harness.experiment.papers import judged

EXPERIMENT = Experiment.from_data(
    {
        "title": "two estimators",
        "stop_time": 1.0,
        "components": {"a": {"signal": "constant", "parameters": {"value": 1.0}}},
        "variants": {"plain": {}, "tuned": {}, "lost": {}},
    },
    Path("two.toml"),
)


def study(seeds: tuple[int, ...], **runs: list[dict[str, float | None]]) -> Evidence:
    return Evidence({}, Study(EXPERIMENT, seeds, {v: tuple(own) for v, own in runs.items()}))


EVIDENCE = {
    "first": study(
        (1, 2, 3),
        plain=[{"peak": 9.0, "rest": 1.0}, {"peak": 20.0, "rest": 2.0}, {"peak": 31.0, "rest": 3}],
        tuned=[{"peak": 7.0, "rest": 1.0}, {"peak": 18.0, "rest": 0.0}, {"peak": 29.0}],
        lost=[{LOST: 1.0}, {LOST: 1.0}, {LOST: 1.0}],
    ),
    "second": study((1, 2, 3), plain=[{"peak": 8.0}, {"peak": 19.0}, {"peak": 30.0}]),
    "other_seeds": study((1, 2), plain=[{"peak": 8.0}, {"peak": 19.0}]),
    "single": Evidence({"plain": {"peak": 6.0, "rest": 3.0}}),
}  # fmt: skip


def found(**test: str) -> Estimate:
    keys = {"experiment": "first", "variant": "plain", "metric": "peak", **test}
    test = CriterionSpec.model_validate({**keys, "below": 0.0})
    return sample_of(test, EVIDENCE.__getitem__)[0].estimate()


def test_a_difference_is_taken_seed_by_seed() -> None:
    """The peaks differ by 22 from seed to seed; the pairs by nothing, so the interval is a point.
    Unpaired, it would be tens wide."""
    assert found(variant="tuned", against="plain") == Estimate(-2.0, -2.0, -2.0, 3)
    assert found(against_experiment="second") == Estimate(1.0, 1.0, 1.0, 3)


def test_two_metrics_of_one_run() -> None:
    values = np.array([8.0, 18.0, 28.0])
    ours = found(against_metric="rest")
    assert ours.value == np.mean(values)
    student = 0.95 * np.sqrt(2.0 / (4.0 * 0.975 * 0.025))  # 97.5 %, two degrees of freedom
    half = student * np.std(values, ddof=1) / np.sqrt(3.0)
    np.testing.assert_allclose([ours.low, ours.high], [18.0 - half, 18.0 + half], rtol=1e-9)
    assert found(experiment="single", against_metric="rest").value == 3.0


def test_a_ratio_of_two_metrics() -> None:
    ours = found(against_metric="rest", compare="ratio")
    assert ours.value == pytest.approx((9.0 + 10.0 + 31.0 / 3.0) / 3.0)
    assert found(experiment="single", against_metric="rest", compare="ratio").value == 2.0


def test_a_pair_without_a_number_or_over_zero_is_counted_as_missing() -> None:
    ours = found(variant="tuned", against_metric="rest", compare="ratio")
    assert (ours.value, ours.runs, ours.missing) == (7.0, 3, 2)


def test_a_variant_whose_runs_all_end_early_meets_no_limit() -> None:
    verdict = judged(
        EVIDENCE.__getitem__, experiment="first", variant="lost", metric="peak", below=99.0
    )
    assert verdict.verdict == "does not hold"
    assert verdict.findings[0].trials[0].ours.missing == 3


@pytest.mark.parametrize("other", ["other_seeds", "single"])
def test_runs_of_different_seeds_are_not_paired(other: str) -> None:
    with pytest.raises(UsageError, match=r"first/plain: peak and .* cannot be paired"):
        found(against_experiment=other)


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        ({"variant": "plan"}, "first: no variant 'plan'; did you mean 'plain'"),
        ({"against_metric": "pek"}, "first: no metric 'pek'; did you mean 'peak'"),
        ({"metric": "region_share"}, "first: no sweep of variant 'plain'; there are none"),
    ],
)
def test_a_wrong_name_is_said_with_the_right_one(wrong: dict[str, str], sentence: str) -> None:
    with pytest.raises(UsageError, match=sentence):
        found(**wrong)


def test_a_ratio_of_nothing_is_refused() -> None:
    with pytest.raises(ValidationError, match="needs what to compare with"):
        found(compare="ratio")
