"""What runs gave, and the sample that a test of a claim takes of it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field

from harness.errors import UsageError, nearest
from harness.experiment.claims import CriterionSpec, Place
from harness.experiment.study import LOST, Study
from harness.experiment.sweep import Region
from harness.results.intervals import Sample

REGION = "region_share"
"""The metric of a sweep: the share of its points that are inside. Where each point has noise of its
own, the points count as runs, and the share has an interval."""


@dataclass(frozen=True)
class Evidence:
    """What the runs of one experiment gave."""

    metrics: Mapping[str, Mapping[str, float | None]]
    study: Study | None = None
    regions: Mapping[str, Region] = field(default_factory=dict)


Source = Callable[[str], Evidence]
"""Gives the evidence of an experiment by name; raises `UsageError` for an unknown one."""


def sample_of(test: CriterionSpec, evidence: Source) -> tuple[Sample, Sample]:
    """The sample that a test is about, and the values that its limit divides, which differ where
    runs are counted. Raises `UsageError` for a name that no run has, and where what is to be paired
    has not the same seeds."""
    seeds, values = _values(test.own, evidence, test.level)
    if test.share_above is not None:
        above = [float(v is None or not v <= test.share_above) for v in values]
        return Sample(tuple(above), is_share=True), Sample(tuple(values))
    if not test.is_comparison:
        if test.metric in (LOST, REGION) and seeds:
            share = Sample(tuple(float(bool(value)) for value in values), is_share=True)
            return share, Sample(())
        sample = Sample(tuple(values))
        return sample, sample
    other_seeds, others = _values(test.other, evidence, test.level)
    if seeds != other_seeds:
        raise UsageError(
            f"{test.own} and {test.other} cannot be paired: {len(values)} and {len(others)} runs "
            "of different seeds"
        )
    pairs = zip(values, others, strict=True)
    sample = Sample(tuple(_compared(a, b, test.compare) for a, b in pairs))
    return sample, sample


def _compared(first: float | None, second: float | None, how: str) -> float | None:
    if first is None or second is None:
        return None
    if how == "ratio":
        return first / second if second else None
    return first - second


def _values(
    place: Place, source: Source, level: float | None
) -> tuple[tuple[int, ...], list[float | None]]:
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
    study = evidence.study
    if study is not None:
        if level is not None:
            _known("level", level, study.levels, place)
            study = study.levels[level]
        seeds, runs = study.seeds, study.runs
    else:
        seeds, runs = (), {variant: (metrics,) for variant, metrics in evidence.metrics.items()}
    _known("variant", place.variant, runs, place)
    metrics = {name for own in runs.values() for run in own for name in run or ()}
    _known("metric", place.metric, metrics, place)
    return seeds, [(run or {}).get(place.metric) for run in runs[place.variant]]


def _known(kind: str, name: str | float, known: Collection[str | float], place: Place) -> None:
    if name not in known:
        hint = nearest(str(name), [str(one) for one in known])
        raise UsageError(f"{place.experiment}: no {kind} {name!r}; {hint}")
