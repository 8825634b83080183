"""The claims of a paper, and what runs say of them.

A claim is data (`claims.toml`): what the paper says, where, and the figure of an experiment that
decides it. The verdict is computed from the runs: over seeds it is the interval of the mean that
must lie wholly on one side of the limit, or the claim stays undecided.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from harness.errors import UsageError, nearest
from harness.experiment.faults import checked, read_toml
from harness.experiment.schema import Strict
from harness.experiment.study import LOST, Study
from harness.experiment.sweep import Region
from harness.results.intervals import Estimate, paired_difference, share

HOLDS, CONDITIONALLY, FAILS = "holds", "holds conditionally", "does not hold"
UNDECIDED, UNTESTABLE = "undecided", "cannot be tested"
REGION = "region_share"
"""The metric of a sweep: the share of its points that are inside. Where each point has noise of its
own, the points count as runs, and the share has an interval."""


@dataclass(frozen=True)
class Place:
    """A metric of a variant of an experiment."""

    experiment: str
    variant: str
    metric: str

    def __str__(self) -> str:
        return f"{self.experiment}/{self.variant}: {self.metric}"


class CriterionSpec(Strict):
    """A figure of an experiment, and the limit that it is held against.

    The figure is the `metric` of a `variant`, or its difference to (its `compare = "ratio"` over)
    another one: that of the variant `against`, of the metric `against_metric`, of the experiment
    `against_experiment`, each by default the test's own. Both are paired by seed.
    """

    experiment: str
    variant: str
    metric: str
    against: str | None = None
    against_metric: str | None = None
    against_experiment: str | None = None
    compare: Literal["difference", "ratio"] = "difference"
    below: float | None = None
    above: float | None = None
    near: tuple[float, float] | None = None

    @model_validator(mode="after")
    def _one_limit(self) -> CriterionSpec:
        if sum(limit is not None for limit in (self.below, self.above, self.near)) != 1:
            raise ValueError("needs exactly one of below, above and near = [value, tolerance]")
        if self.compare == "ratio" and self.other == self.own:
            raise ValueError(
                'compare = "ratio" needs what to compare with: against, against_metric or '
                "against_experiment"
            )
        return self

    @property
    def own(self) -> Place:
        """Where the figure stands."""
        return Place(self.experiment, self.variant, self.metric)

    @property
    def other(self) -> Place:
        """Where that stands which it is compared with; `own` where it is compared with nothing."""
        return Place(
            self.against_experiment or self.experiment,
            self.against or self.variant,
            self.against_metric or self.metric,
        )


class ClaimSpec(Strict):
    """One claim: `paper` is its number or words, the rest as in the module docstring."""

    id: str
    page: str
    claim: str
    paper: float | str = ""
    unit: str = ""
    test: CriterionSpec | None = None
    given: CriterionSpec | None = None
    untestable: str | None = None
    reason: str = ""

    @property
    def said(self) -> str:
        """The paper's number with its unit, or its words."""
        if isinstance(self.paper, float):
            return f"{self.paper:g} {self.unit}".strip()
        return self.paper

    @model_validator(mode="before")
    @classmethod
    def _flat(cls, data: object) -> object:
        """The keys of the test may stand in the claim itself."""
        if isinstance(data, dict) and "experiment" in data:
            names = set(CriterionSpec.model_fields)
            own = {k: v for k, v in data.items() if k not in names}
            return {**own, "test": {k: v for k, v in data.items() if k in names}}
        return data

    @model_validator(mode="after")
    def _decidable(self) -> ClaimSpec:
        if (self.test is None) == (self.untestable is None):
            raise ValueError("needs either a test (experiment, variant, metric) or untestable")
        return self


class ClaimsSpec(Strict):
    """A whole `claims.toml`."""

    paper: str
    claims: tuple[ClaimSpec, ...] = Field(min_length=1)


@dataclass(frozen=True)
class Verdict:
    """A claim with what the runs say of it; `given` belongs to the condition."""

    claim: ClaimSpec
    verdict: str
    ours: Estimate | None = None
    given: Estimate | None = None


@dataclass(frozen=True)
class Evidence:
    """What the runs of one experiment gave."""

    metrics: Mapping[str, Mapping[str, float | None]]
    study: Study | None = None
    regions: Mapping[str, Region] = field(default_factory=dict)


Source = Callable[[str], Evidence]
"""Gives the evidence of an experiment by name; raises `UsageError` for an unknown one."""


def load_claims(path: Path) -> ClaimsSpec:
    """Read `claims.toml`; raises `ExperimentError` with one line for each fault."""
    return checked(ClaimsSpec, read_toml(path, "claims file"), str(path))


def judge(claim: ClaimSpec, evidence: Source) -> Verdict:
    """The verdict on one claim."""
    if claim.test is None:
        return Verdict(claim, UNTESTABLE)
    ours = figure(claim.test, evidence)
    met = _met(claim.test, ours)
    given = None
    if claim.given is not None:
        given = figure(claim.given, evidence)
        if met is not True and _met(claim.given, given) is True:
            return Verdict(claim, CONDITIONALLY, ours, given)
    return Verdict(claim, {True: HOLDS, False: FAILS, None: UNDECIDED}[met], ours, given)


def figure(test: CriterionSpec, evidence: Source) -> Estimate:
    """The figure that a test is about; raises `UsageError` for a name that no run has, and where
    what is to be paired has not the same seeds."""
    seeds, values = _values(test.own, evidence)
    if test.other == test.own:
        if test.metric in (LOST, REGION) and seeds:
            return share([bool(value) for value in values])
        return _summary(values)
    other_seeds, others = _values(test.other, evidence)
    if seeds != other_seeds:
        raise UsageError(
            f"{test.own} and {test.other} cannot be paired: {len(values)} and {len(others)} runs "
            "of different seeds"
        )
    pairs = zip(values, others, strict=True)
    return _summary([_compared(a, b, test.compare) for a, b in pairs])


def _compared(first: float | None, second: float | None, how: str) -> float | None:
    if first is None or second is None:
        return None
    if how == "ratio":
        return first / second if second else None
    return first - second


def _values(place: Place, source: Source) -> tuple[tuple[int, ...], list[float | None]]:
    """The seeds of a study with the values that belong to them, or () with the one value."""
    evidence = source(place.experiment)
    if place.metric == REGION:
        _known("sweep of variant", place.variant, evidence.regions, place)
        region = evidence.regions[place.variant]
        if region.spec.own_seeds:  # each point is a run of its own, and the share an estimate
            inside = [float(one) for one in region.inside.ravel()]
            return tuple(range(len(inside))), list(inside)
        return (), [region.share]
    runs: Mapping[str, Sequence[Mapping[str, float | None] | None]]
    if evidence.study is not None:
        seeds, runs = evidence.study.seeds, evidence.study.runs
    else:
        seeds, runs = (), {variant: (metrics,) for variant, metrics in evidence.metrics.items()}
    _known("variant", place.variant, runs, place)
    metrics = {name for own in runs.values() for run in own for name in run or ()}
    _known("metric", place.metric, metrics, place)
    return seeds, [(run or {}).get(place.metric) for run in runs[place.variant]]


def _known(kind: str, name: str, known: Collection[str], place: Place) -> None:
    if name not in known:
        raise UsageError(f"{place.experiment}: no {kind} {name!r}; {nearest(name, known)}")


def _summary(values: Sequence[float | None]) -> Estimate:
    numbers = [v for v in values if v is not None and np.isfinite(v)]
    if len(numbers) > 1:
        return paired_difference(values, np.zeros(len(values)))
    one = float(numbers[0]) if numbers else np.nan
    runs = 0 if not numbers and len(values) == 1 else len(values)
    return Estimate(one, one, one, runs, len(values) - len(numbers))


def _met(test: CriterionSpec, found: Estimate) -> bool | None:
    """Whether the whole interval meets the limit; None where it lies across. A figure that does
    not exist in most runs (a loop that never settles) meets none."""
    if found.runs == 0 or 2 * found.missing >= max(found.runs, 1) or np.isnan(found.value):
        return False
    if test.near is not None:
        low, high = test.near[0] - test.near[1], test.near[0] + test.near[1]
        if low <= found.low and found.high <= high:
            return True
        return None if found.high >= low and found.low <= high else False
    if test.below is not None:
        return True if found.high < test.below else (False if found.low >= test.below else None)
    assert test.above is not None
    return True if found.low > test.above else (False if found.high <= test.above else None)
