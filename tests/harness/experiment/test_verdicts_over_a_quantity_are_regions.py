"""A claim about a study with levels is judged at each; the verdict says where it holds."""

from pathlib import Path

import pytest

from harness.experiment import verdict_text
from harness.experiment.claims import ClaimsSpec
from harness.experiment.evidence import Evidence
from harness.experiment.experiment import Experiment
from harness.experiment.judging import HOLDS, PARTLY, RESTS, Verdict, family_size, judge
from harness.experiment.study import Study
from harness.experiment.verdict_plot import verdict_plot
from tests.harness.experiment.papers import judged

LEVELS = (1.0, 2.0, 4.0)
EXPERIMENT = Experiment.from_data(
    {
        "title": "errors that are as large as the noise",
        "stop_time": 1.0,
        "components": {"a": {"signal": "constant", "parameters": {"value": 1.0}}},
        "variants": {"one": {}},
        "study": {
            "seeds": 10, "baseline": "one",
            "levels": {"quantity": "noise", "unit": "N", "nominal": 2.0, "values": LEVELS,
                       "keys": ["components.a.parameters.value"]},
        },
    },
    Path("two.toml"),
)  # fmt: skip
SEEDS = tuple(range(10))


def study(level: float) -> Study:
    runs = tuple({"true": level + 0.01 * (seed % 3), "seen": 9.0 + 0.01 * seed} for seed in SEEDS)
    return Study(EXPERIMENT, SEEDS, {"one": runs})


AT = {level: study(level) for level in LEVELS}
EVIDENCE = Evidence({}, Study(EXPERIMENT, SEEDS, AT[2.0].runs, AT))


def verdict(**claim: object) -> Verdict:
    return judged(EVIDENCE, **{"variant": "one", "metric": "true", **claim})


def test_where_it_holds_and_where_it_turns() -> None:
    found = verdict(below=3.0)
    assert found.verdict == PARTLY and found.findings[0].border == pytest.approx(2.99, abs=0.01)
    assert verdict_text.said(found) == (
        "noise in N: holds for 1 to 2, does not hold at 4; the mean crosses the limit near 2.99"
    )
    assert verdict_text.ours(found).startswith("at 1: 1.01 [")


def test_everywhere_and_at_one_level() -> None:
    assert verdict_text.said(verdict(below=5.0)) == "holds (noise 1 to 4 N)"
    assert verdict(below=3.0, level=2.0).verdict == HOLDS


def test_a_curve_over_the_limit_of_a_share() -> None:
    """At the nominal level values lie between 2 and 2.02: all above 1.9, none above 2.1."""
    claim = {"share_above": 2.01, "above": 0.5}
    assert verdict(level=2.0, **claim).verdict == RESTS
    found = verdict(curve=[1.9, 2.1], **claim)
    assert [trial.at for trial in found.findings[0].trials] == [1.9, 2.01, 2.1]
    assert [trial.ours.value for trial in found.findings[0].trials] == [1.0, 0.3, 0.0]
    assert verdict_text.said(found).startswith("limit of true: holds at 1.9, ")


def test_a_limit_amid_the_runs_decides_nothing() -> None:
    assert verdict(level=2.0, below=2.005).verdict == RESTS
    assert verdict(level=2.0, above=2.005).verdict == RESTS


def test_a_picture_has_the_limit_and_the_units() -> None:
    figure = verdict_plot(verdict(below=3.0, unit="%"))
    assert figure is not None
    (panel,) = figure.axes
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("noise (N)", "true (%)")
    limits = [line for line in panel.lines if line.get_linestyle() == "--"]
    assert [set(line.get_ydata()) for line in limits] == [{3.0}]
    assert verdict_plot(verdict(below=3.0, level=2.0)) is None


def test_both_readings_of_an_error_and_how_many_tests_that_makes() -> None:
    claim = {"id": "c", "page": "1", "claim": "c", "experiment": "two", "variant": "one"}
    claims = ClaimsSpec.model_validate(
        {
            "paper": "p",
            "claims": [{**claim, "metric": "true", "below": 5.0}],
            "readings": {"true": {"of the force": "true", "of its measurement": "seen"}},
        }
    )
    assert family_size(claims, {"two": EXPERIMENT.spec}) == 6
    (found,) = judge(claims, lambda name: EVIDENCE)
    assert verdict_text.said(found) == (
        "of the force: holds (noise 1 to 4 N); of its measurement: does not hold (noise 1 to 4 N)"
    )
    alike = claims.model_copy(update={"readings": {"true": {"once": "true", "again": "true"}}})
    (found,) = judge(alike, lambda name: EVIDENCE)
    assert verdict_text.said(found) == "once and again: holds (noise 1 to 4 N)"
