"""A study: every variant over many seeds, differences paired by seed, with intervals.

All variants meet the same noise under the same seed, so differences are taken seed by seed. A
metric that does not exist in a run (a loop that never settles) leaves its pair out; how many were
left out is reported, and so is the share of runs in which a variant loses the loop.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd
from rich.table import Table

from harness.errors import ExperimentError, HarnessError
from harness.experiment.experiment import Experiment
from harness.experiment.foresight import check_metrics
from harness.experiment.journal import Journal, Metrics, Point, Settings
from harness.experiment.parallel import Workers
from harness.experiment.repeated import run_points, setting
from harness.experiment.schema import LevelsSpec, StudySpec
from harness.results.atomic import atomic_write, writing
from harness.results.intervals import Estimate, paired_difference, share

LOST = "lost_loop"


@dataclass(frozen=True)
class Study:
    """Metrics of every run: `runs[variant][i]` belongs to seed `seeds[i]`; None where a study that
    ended early has not run it. With `[study.levels]` these are the runs at the nominal one, and
    `levels` has a study of each value."""

    experiment: Experiment
    seeds: tuple[int, ...]
    runs: Mapping[str, tuple[Metrics | None, ...]]
    levels: Mapping[float, Study] = field(default_factory=dict)

    @property
    def spec(self) -> StudySpec:
        """The table `[study]`; raises `ExperimentError` where there is none."""
        if self.experiment.spec.study is None:
            raise ExperimentError(f"{self.experiment.path} has no table [study]")
        return self.experiment.spec.study

    def values(self, variant: str, metric: str) -> list[float | None]:
        """A metric of one variant over the seeds."""
        return [None if one is None else one.get(metric) for one in self.runs[variant]]

    def done(self, variant: str) -> int:
        """How many runs of a variant there are."""
        return sum(one is not None for one in self.runs[variant])

    @property
    def complete(self) -> bool:
        """Whether every variant was run with every seed."""
        return all(self.done(variant) == len(self.seeds) for variant in self.runs)

    def difference(self, variant: str, metric: str) -> Estimate:
        """variant − baseline, paired by seed, at the study's confidence."""
        first, second = (self.values(one, metric) for one in (variant, self.spec.baseline))
        return paired_difference(first, second, confidence=self.spec.confidence)

    def lost(self, variant: str) -> Estimate:
        """The share of runs in which the variant loses the loop."""
        runs = (one for one in self.runs[variant] if one is not None)
        happened = [bool(metrics.get(LOST, not metrics)) for metrics in runs]
        return share(happened, confidence=self.spec.confidence)

    def frame(self) -> pd.DataFrame:
        """One row a run: the level where there are some, variant, seed and all metrics."""
        quantity = "" if self.spec.levels is None else self.spec.levels.quantity
        studies = [({quantity: level}, study) for level, study in self.levels.items()]
        return pd.DataFrame(
            [
                {**at, "variant": variant, "seed": seed, **metrics}
                for at, study in studies or [({}, self)]
                for variant, runs in study.runs.items()
                for seed, metrics in zip(study.seeds, runs, strict=True)
                if metrics is not None
            ]
        )

    def write(self, folder: Path) -> Path:
        """Write `study.csv` into `folder` and return its path."""
        path = folder / "study.csv"
        with writing(f"{path} cannot be written", folder), atomic_write(path) as partial:
            self.frame().to_csv(partial, index=False)
        return path


def run_study(
    experiment: Experiment,
    variants: Sequence[str] | None = None,
    *,
    workers: Workers | None = None,
    progress: Callable[[float], None] | None = None,
    journal: Journal | None = None,
) -> Study:
    """Run all variants, or some, over the seeds and the levels of `[study]`, spread over `workers`.

    `workers` are as those of `run_points`; a run that ends early is a lost loop without metrics.
    What the `journal` has is not run again. A fault, and Ctrl-C, has in `result` the study as far
    as it was done.
    """
    check_metrics(experiment)
    journal, spec = journal or Journal(), Study(experiment, (), {}).spec
    chosen = variants or spec.variants or experiment.variants
    points = _points_of_levels(experiment, spec)
    rows = list(points.values()) if spec.levels is not None else [[p] for p in points[None]]
    try:
        run_points(experiment, chosen, rows, journal, workers=workers, progress=progress)
    except (KeyboardInterrupt, HarnessError) as fault:
        fault.result = study_so_far(experiment, journal, chosen)  # type: ignore[union-attr]
        raise
    return study_so_far(experiment, journal, chosen)


def study_so_far(experiment: Experiment, journal: Journal, variants: Sequence[str]) -> Study:
    """The study of what is in the journal; nothing is run."""
    study = Study(experiment, (), {})
    seeds, levels = _seeds(experiment, study.spec), study.spec.levels
    at = {
        value: replace(
            study,
            seeds=seeds,
            runs={v: tuple(_or_lost(journal, v, point) for point in own) for v in variants},
        )
        for value, own in _points_of_levels(experiment, study.spec).items()
    }
    if levels is None:
        return at[None]
    by_value = {value: one for value, one in at.items() if value is not None}
    return replace(by_value[levels.nominal], levels=by_value)


def _seeds(experiment: Experiment, spec: StudySpec) -> tuple[int, ...]:
    return tuple(range(experiment.spec.seed, experiment.spec.seed + spec.seeds))


def _points_of_levels(experiment: Experiment, spec: StudySpec) -> dict[float | None, list[Point]]:
    """The runs by value of the quantity, None where there is none."""
    values = (None,) if spec.levels is None else spec.levels.values
    seeds = _seeds(experiment, spec)
    return {value: _points(experiment, seeds, spec.levels, value) for value in values}


def _points(
    experiment: Experiment, seeds: Sequence[int], levels: LevelsSpec | None, value: float | None
) -> list[Point]:
    """The runs of all seeds, at a value of the quantity where there is one."""
    if levels is None or value is None:
        return [Point(f"seed {seed}", seed) for seed in seeds]
    settings, name = level_settings(experiment, levels, value), f"{levels.quantity} {value:g}"
    return [Point(f"{name}, seed {seed}", seed, settings) for seed in seeds]


def level_settings(experiment: Experiment, levels: LevelsSpec, value: float) -> Settings:
    """What is set at a value of the quantity; raises `ExperimentError` for a key that is none."""
    found = []
    for key in levels.keys:
        try:
            given = setting(experiment.data, key) if levels.factor else 1.0
            found.append((key, given * value))
        except (LookupError, TypeError, ValueError) as fault:
            raise ExperimentError(
                f"{experiment.path}: study.levels.keys {key!r}: the file gives no number for it "
                "that a factor could change"
            ) from fault
    return tuple(found)


def _or_lost(journal: Journal, variant: str, point: Point) -> Metrics | None:
    if (variant, point) not in journal.found:
        return None
    metrics = journal.found[variant, point]
    return {LOST: 1.0} if metrics is None else metrics


def study_tables(experiment: Experiment, study: Study) -> list[Table]:
    """Means, paired differences to the baseline with intervals, and shares of lost loops."""
    spec = study.spec
    percent = f"{100 * spec.confidence:g} %"
    some = "" if study.complete else f" ({sum(map(study.done, study.runs))} runs done)"
    means = Table(title=f"median over {len(study.seeds)} seeds{some}", title_justify="left")
    title = f"difference to {experiment.label(spec.baseline)}, paired, {percent} interval"
    differences = Table(title=title, title_justify="left")
    for table in (means, differences):
        table.add_column("variant")
        for metric in spec.metrics:
            table.add_column(metric.replace("_", " "), justify="right")
    means.add_column(f"loop lost ({percent} interval)", justify="right")
    for variant in study.runs:
        runs = [one for one in study.runs[variant] if one is not None]
        means.add_row(
            experiment.label(variant),
            *(median([run.get(metric) for run in runs]) for metric in spec.metrics),
            _lost(study, variant) if runs else "–",
        )
        if variant != spec.baseline and spec.baseline in study.runs:
            cells = [_difference(study, variant, metric) for metric in spec.metrics]
            differences.add_row(experiment.label(variant), *cells)
    return [means, differences] if differences.row_count else [means]


def _lost(study: Study, variant: str) -> str:
    lost = study.lost(variant)
    return f"{lost.value:.0%} [{lost.low:.0%}, {lost.high:.0%}]"


def median(values: list[float | None]) -> str:
    """The median of what exists, and how many do not."""
    numbers = [value for value in values if value is not None and np.isfinite(value)]
    missing = f" ({len(values) - len(numbers)} without)" if len(numbers) < len(values) else ""
    return (f"{np.median(numbers):.4g}" if numbers else "–") + missing


def _difference(study: Study, variant: str, metric: str) -> str:
    try:
        d = study.difference(variant, metric)
    except HarnessError:
        return "–"
    return f"{d.value:+.3g} [{d.low:+.3g}, {d.high:+.3g}]"
