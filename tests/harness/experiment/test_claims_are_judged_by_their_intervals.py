"""A claim holds where the whole interval meets its limit, fails where none of it does."""

from pathlib import Path

import pytest
from scipy import stats

from harness.errors import ExperimentError, UsageError
from harness.experiment.claims import load_claims
from harness.experiment.evidence import Evidence
from harness.experiment.experiment import Experiment
from harness.experiment.judging import CONDITIONALLY, FAILS, HOLDS, UNDECIDED
from harness.experiment.study import LOST, Study
from harness.results.intervals import Estimate
from tests.harness.experiment.papers import CLAIMS, judged

TEXT = {
    "title": "two variants",
    "stop_time": 1.0,
    "components": {"a": {"signal": "constant", "parameters": {"value": 1.0}}},
    "variants": {"a": {}, "b": {}},
    "study": {"seeds": 4, "baseline": "a"},
}
EXPERIMENT = Experiment.from_data(TEXT, Path("two.toml"))
A, B = [1.0, 2.0, 3.0, 4.0], [1.5, 2.6, 3.4, 4.5]
RUNS = {
    "a": tuple({"m": m, "gone": None, LOST: 0.0} for m in A),
    "b": tuple({"m": m, "gone": 1.0 if m > 4 else None, LOST: float(m > 2)} for m in B),
}
STUDY = Evidence({}, Study(EXPERIMENT, (0, 1, 2, 3), RUNS), {})
SINGLE = Evidence({"a": {"m": 1.0, "gone": None}, "b": {"m": 1.5, "gone": 2.0}}, None, {})


def verdict(evidence: Evidence, variant: str, metric: str, **more: object) -> tuple[str, Estimate]:
    found = judged(evidence, variant=variant, metric=metric, **more)
    return found.verdict, found.findings[0].trials[0].ours


@pytest.mark.parametrize(
    ("limit", "expected"),
    [
        ({"below": 5.0}, HOLDS), ({"below": 4.0}, UNDECIDED), ({"below": 0.1}, FAILS),
        ({"above": 0.1}, HOLDS), ({"above": 1.5}, UNDECIDED), ({"above": 5.0}, FAILS),
        ({"near": [2.5, 3.0]}, HOLDS), ({"near": [2.5, 1.0]}, UNDECIDED),
        ({"near": [9.0, 1.0]}, FAILS),
    ],
)  # fmt: skip
def test_the_mean_over_seeds(limit: dict[str, object], expected: str) -> None:
    """Mean 2.5, interval of Student's t with 3 degrees of freedom: 2.5 ± 2.054; of two one-sided
    tests at 5 %, that of 90 %."""
    found, ours = verdict(STUDY, "a", "m", **limit)
    half = stats.t.ppf(0.95 if "near" in limit else 0.975, 3) * stats.tstd(A) / 2
    assert found == expected
    assert ours.low == pytest.approx(2.5 - half) and ours.runs == 4
    assert ours.high == pytest.approx(2.5 + half)


def test_differences_are_paired() -> None:
    """Of the pairs 0.5, 0.6, 0.4, 0.5 the interval is narrow; those of a and b apart overlap."""
    assert verdict(STUDY, "b", "m", against="a", above=0.3)[0] == HOLDS
    assert verdict(STUDY, "b", "m", above=4.4, curve=[4.4])[0] == UNDECIDED


def test_a_single_run_decides_by_its_value() -> None:
    assert verdict(SINGLE, "a", "m", below=1.0)[0] == FAILS
    assert verdict(SINGLE, "a", "m", near=[1.0, 0.0])[0] == HOLDS
    assert verdict(SINGLE, "b", "m", against="a", near=[0.5, 1e-12])[0] == HOLDS


def test_a_figure_that_does_not_exist_meets_no_limit() -> None:
    for evidence in (SINGLE, STUDY):
        for limit in ({"below": 1e9}, {"above": -1e9}):
            assert verdict(evidence, "a", "gone", **limit)[0] == FAILS
    found, ours = verdict(STUDY, "b", "gone", above=0.0)
    assert ours.missing == 3 and found == FAILS


def test_lost_loops_are_a_share_with_its_own_interval() -> None:
    """Three of four: the Wilson interval is from 30 to 95 %."""
    assert verdict(STUDY, "b", LOST, above=0.29)[0] == HOLDS
    found, ours = verdict(STUDY, "b", LOST, above=0.31)
    assert ours.value == 0.75 and found == UNDECIDED
    assert 0.29 < ours.low < 0.31 < 0.75 < ours.high < 1.0


def test_what_holds_only_under_a_condition() -> None:
    """The condition is another experiment; in the first the figure is 1, in the other 1.5."""
    other = Evidence({"a": {"m": 1.5}})
    evidence = {"two": SINGLE, "other": other}.__getitem__
    given = {"experiment": "other", "variant": "a", "metric": "m"}
    for limit, expected in ((1.2, CONDITIONALLY), (0.5, HOLDS), (2.0, FAILS)):
        claim = {"variant": "a", "metric": "m", "above": limit, "given": {**given, "above": limit}}
        assert judged(evidence, **claim).verdict == expected


@pytest.mark.parametrize(
    ("variant", "metric", "words"),
    [("c", "m", "no variant 'c'"), ("a", "mm", "no metric 'mm'; did you mean 'm'")],
)
def test_names_that_are_not_there(variant: str, metric: str, words: str) -> None:
    for evidence in (SINGLE, STUDY):
        with pytest.raises(UsageError, match=words):
            verdict(evidence, variant, metric, below=1.0)


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("below = 0.0", "", "exactly one of below, above and near"),
        ("below = 0.0", "below = 0.0\nabove = 1.0", "exactly one of below, above and near"),
        ('untestable = "there', 'untestabel = "there', "untestabel: unknown key"),
        ("[[claims]]", "[claims]", "claims file .* is no valid TOML"),
    ],
)
def test_faults_of_a_file(tmp_path: Path, before: str, after: str, words: str) -> None:
    assert before in CLAIMS
    path = tmp_path / "claims.toml"
    path.write_text(CLAIMS.replace(before, after), encoding="utf-8")
    with pytest.raises(ExperimentError, match=words):
        load_claims(path)
