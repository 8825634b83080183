"""A study: every variant over many seeds, differences paired by seed, with intervals.

All variants meet the same noise under the same seed, so differences are taken seed by seed. A
metric that does not exist in a run (a loop that never settles) leaves its pair out; how many were
left out is reported, and so is the share of runs in which a variant loses the loop.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd
from rich.table import Table

from harness.errors import ExperimentError, HarnessError
from harness.experiment.experiment import Experiment
from harness.experiment.parallel import Workers
from harness.experiment.repeated import Metrics, Point, run_points
from harness.experiment.schema import StudySpec
from harness.results.atomic import atomic_write, writing
from harness.results.intervals import Estimate, paired_difference, share

LOST = "lost_loop"


@dataclass(frozen=True)
class Study:
    """Metrics of every run: `runs[variant][i]` belongs to seed `seeds[i]`."""

    experiment: Experiment
    seeds: tuple[int, ...]
    runs: Mapping[str, tuple[Metrics, ...]]

    @property
    def spec(self) -> StudySpec:
        """The table `[study]`; raises `ExperimentError` where there is none."""
        if self.experiment.spec.study is None:
            raise ExperimentError(f"{self.experiment.path} has no table [study]")
        return self.experiment.spec.study

    def values(self, variant: str, metric: str) -> list[float | None]:
        """A metric of one variant over the seeds."""
        return [metrics.get(metric) for metrics in self.runs[variant]]

    def difference(self, variant: str, metric: str) -> Estimate:
        """variant − baseline, paired by seed, at the study's confidence."""
        first, second = (self.values(one, metric) for one in (variant, self.spec.baseline))
        return paired_difference(first, second, confidence=self.spec.confidence)

    def lost(self, variant: str) -> Estimate:
        """The share of runs in which the variant loses the loop."""
        happened = [bool(metrics.get(LOST, not metrics)) for metrics in self.runs[variant]]
        return share(happened, confidence=self.spec.confidence)

    def frame(self) -> pd.DataFrame:
        """One row a run: variant, seed and all metrics."""
        return pd.DataFrame(
            [
                {"variant": variant, "seed": seed, **metrics}
                for variant, runs in self.runs.items()
                for seed, metrics in zip(self.seeds, runs, strict=True)
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
    *,
    workers: Workers | None = None,
    progress: Callable[[float], None] | None = None,
) -> Study:
    """Run all variants over the seeds of `[study]`, spread over `workers`.

    `workers` are as those of `run_points`; a run that ends early is a lost loop without metrics.
    """
    study = Study(experiment, (), {})
    seeds = tuple(range(experiment.spec.seed, experiment.spec.seed + study.spec.seeds))
    rows = [[Point(f"seed {seed}", seed)] for seed in seeds]
    found = run_points(
        experiment, experiment.variants, rows, _or_lost, workers=workers, progress=progress
    )
    return replace(study, seeds=seeds, runs={v: tuple(runs) for v, runs in found.items()})


def _or_lost(metrics: Metrics | None) -> Metrics:
    return {LOST: 1.0} if metrics is None else metrics


def study_tables(experiment: Experiment, study: Study) -> list[Table]:
    """Means, paired differences to the baseline with intervals, and shares of lost loops."""
    spec = study.spec
    percent = f"{100 * spec.confidence:g} %"
    means = Table(title=f"median over {len(study.seeds)} seeds", title_justify="left")
    title = f"difference to {experiment.label(spec.baseline)}, paired, {percent} interval"
    differences = Table(title=title, title_justify="left")
    for table in (means, differences):
        table.add_column("variant")
        for metric in spec.metrics:
            table.add_column(metric.replace("_", " "), justify="right")
    means.add_column(f"loop lost ({percent} interval)", justify="right")
    for variant in experiment.variants:
        lost = study.lost(variant)
        means.add_row(
            experiment.label(variant),
            *(median(study.values(variant, metric)) for metric in spec.metrics),
            f"{lost.value:.0%} [{lost.low:.0%}, {lost.high:.0%}]",
        )
        if variant != spec.baseline:
            cells = [_difference(study, variant, metric) for metric in spec.metrics]
            differences.add_row(experiment.label(variant), *cells)
    return [means, differences]


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
