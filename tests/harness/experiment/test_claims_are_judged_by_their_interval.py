"""A verdict needs the whole interval on one side of the limit; across it, nothing is decided."""

import math
from pathlib import Path

import numpy as np
import pytest

from harness.experiment.claims import ClaimSpec, CriterionSpec, Evidence, figure, judge
from harness.experiment.experiment import Experiment
from harness.experiment.schema import SweepSpec
from harness.experiment.study import LOST, Study
from harness.experiment.sweep import Region
from harness.results.intervals import Estimate

EXPERIMENT = Experiment.from_data(
    {
        "title": "a loop",
        "stop_time": 1.0,
        "components": {"a": {"signal": "constant", "parameters": {"value": 1.0}}},
        "variants": {"one": {}, "two": {}},
    },
    Path("loop.toml"),
)
SEEDS = tuple(range(20))


def spread(mean: float) -> tuple[dict[str, float | None], ...]:
    """Errors about `mean` with an interval of ±0.48; one run of 20 loses its loop."""
    return tuple(
        {"error": mean + (1.0 if seed % 2 else -1.0), LOST: float(seed == 0)} for seed in SEEDS
    )


STUDY = Study(EXPERIMENT, SEEDS, {"one": spread(2.0), "two": spread(3.0)})
EVIDENCE = Evidence({}, STUDY)


def verdict(test: dict[str, object], given: dict[str, object] | None = None) -> str:
    place = {"experiment": "loop", "variant": "one", "metric": "error"}
    claim = {"id": "c", "page": "1", "claim": "c", "test": {**place, **test}}
    if given is not None:
        claim["given"] = {**place, **given}
    return judge(ClaimSpec.model_validate(claim), lambda name: EVIDENCE).verdict


@pytest.mark.parametrize(
    ("limit", "expected"),
    [
        ({"below": 2.5}, "holds"),
        ({"below": 2.4}, "undecided"),
        ({"below": 1.5}, "does not hold"),
        ({"above": 1.5}, "holds"),
        ({"above": 1.6}, "undecided"),
        ({"above": 2.5}, "does not hold"),
        ({"near": [2.0, 0.5]}, "holds"),
        ({"near": [2.0, 0.4]}, "undecided"),
        ({"near": [3.0, 0.4]}, "does not hold"),
    ],
)
def test_the_whole_interval_decides(limit: dict[str, object], expected: str) -> None:
    assert verdict(limit) == expected


def test_a_condition_counts_only_where_the_claim_does_not_hold_without_it() -> None:
    failing, met = {"above": 2.5}, {"variant": "two", "above": 2.5}
    assert verdict(failing, met) == "holds conditionally"
    assert verdict({"above": 1.5}, met) == "holds"
    assert verdict(failing, {"variant": "two", "above": 3.5}) == "does not hold"


def test_lost_loops_are_a_share_with_an_interval_of_its_own() -> None:
    """One of 20: the Wilson interval reaches from 1 % to 24 %, so that a limit of
    10 % is not decided by 20 runs."""
    test = CriterionSpec(experiment="loop", variant="one", metric=LOST, below=0.1)
    ours = figure(test, lambda name: EVIDENCE)
    assert ours.value == 0.05
    assert 0.0 < ours.low < 0.05 < 0.2 < ours.high < 0.3
    assert verdict({"metric": LOST, "below": 0.1}) == "undecided"


def found_region(own_seeds: bool, against: str | None = None) -> Estimate:
    """Wide has three of its four points inside, small one of these."""
    axis = {"key": "a", "from": 0.0, "to": 1.0, "count": 2}
    sweep = SweepSpec.model_validate(
        {"outcome": "error", "below": 1.0, "x": axis, "y": axis, "own_seeds": own_seeds}
    )
    outcomes = {"wide": [[0.0, 0.5], [0.9, 1.0]], "small": [[0.0, 1.0], [math.nan, 2.0]]}
    regions = {name: Region(name, sweep, np.array(rows)) for name, rows in outcomes.items()}
    test = CriterionSpec(
        experiment="loop", variant="wide", against=against, metric="region_share", above=0.4
    )
    return figure(test, lambda name: Evidence({}, None, regions))


def test_shares_of_regions_are_compared_as_they_are() -> None:
    assert found_region(own_seeds=False) == Estimate(0.75, 0.75, 0.75, 1)
    assert found_region(own_seeds=False, against="small") == Estimate(0.5, 0.5, 0.5, 1)


def test_points_with_noise_of_their_own_are_runs() -> None:
    share = found_region(own_seeds=True)
    assert (share.value, share.runs) == (0.75, 4)
    assert 0.2 < share.low < 0.4 and 0.9 < share.high < 1.0
    difference = found_region(own_seeds=True, against="small")  # 0, 1, 1, 0 point by point
    assert (difference.value, difference.runs) == (0.5, 4)
    assert difference.low < 0.0 < 1.0 < difference.high
