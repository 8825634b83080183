"""The share of the points of a sweep that are inside is a figure like any other."""

import math

import numpy as np

from harness.experiment.claims import CriterionSpec
from harness.experiment.evidence import Evidence, sample_of
from harness.experiment.schema import SweepSpec
from harness.experiment.sweep import Region
from harness.results.intervals import Estimate


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
    return sample_of(test, lambda name: Evidence({}, None, regions))[0].estimate()


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
