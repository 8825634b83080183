"""A study: every variant over many seeds, differences paired by seed, with intervals.

All variants meet the same noise under the same seed, so differences are taken seed by seed. A
metric that does not exist in a run (a loop that never settles) leaves its pair out; how many were
left out is reported, and so is the share of runs in which a variant loses the loop.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from rich.table import Table

from harness.errors import ExperimentError, HarnessError, RecordingError
from harness.experiment.experiment import Experiment, PreparedVariant
from harness.experiment.parallel import Workers, given_or_one
from harness.process.watchdog import allow
from harness.results.atomic import atomic_write
from harness.results.intervals import PairedDifference, Share, paired_difference, share

Metrics = Mapping[str, float | None]
Task = tuple[str, tuple[int, ...]]
"""A variant and some of its seeds."""
LOST = "lost_loop"
_CHUNKS = 4  # tasks of a variant that a worker gets, so that progress moves and the load evens out


@dataclass(frozen=True)
class Study:
    """Metrics of every run: `runs[variant][i]` belongs to seed `seeds[i]`."""

    experiment: Experiment
    seeds: tuple[int, ...]
    runs: Mapping[str, tuple[Metrics, ...]]

    def values(self, variant: str, metric: str) -> list[float | None]:
        """A metric of one variant over the seeds."""
        return [metrics.get(metric) for metrics in self.runs[variant]]

    def difference(self, variant: str, metric: str) -> PairedDifference:
        """variant − baseline, paired by seed, at the study's confidence."""
        spec = self.experiment.spec.study
        assert spec is not None
        first, second = self.values(variant, metric), self.values(spec.baseline, metric)
        return paired_difference(first, second, confidence=spec.confidence)

    def lost(self, variant: str) -> Share:
        """The share of runs in which the variant loses the loop."""
        spec = self.experiment.spec.study
        assert spec is not None
        happened = [bool(metrics.get(LOST, not metrics)) for metrics in self.runs[variant]]
        return share(happened, confidence=spec.confidence)

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
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with atomic_write(path) as partial:
                self.frame().to_csv(partial, index=False)
        except OSError as fault:
            raise RecordingError(f"{path} cannot be written: {fault}") from fault
        return path


def run_study(
    experiment: Experiment,
    *,
    workers: Workers | None = None,
    progress: Callable[[float], None] | None = None,
) -> Study:
    """Run all variants over the seeds of `[study]`, spread over `workers`.

    None: one process of its own, as any run has; `Workers(1)` runs in this one. A run that kills
    its process is run again under a supervisor, and counts as a lost loop if it does so again.
    """
    spec = experiment.spec.study
    if spec is None:
        raise ExperimentError(f"{experiment.path} has no table [study]")
    seeds = tuple(range(experiment.spec.seed, experiment.spec.seed + spec.seeds))
    found: dict[tuple[str, int], Metrics] = {}
    with given_or_one(workers) as crew:
        tasks = _tasks(experiment, seeds, crew.count)
        for (variant, some), metrics in crew.spread(
            partial(_run_seeds, experiment), tasks, careful=partial(_run_apart, experiment)
        ):
            found |= {(variant, seed): one for seed, one in zip(some, metrics, strict=True)}
            if progress is not None:
                progress(len(found) / (len(seeds) * len(experiment.variants)))
    runs = {v: tuple(found[v, seed] for seed in seeds) for v in experiment.variants}
    return Study(experiment, seeds, runs)


def _tasks(experiment: Experiment, seeds: tuple[int, ...], workers: int) -> list[Task]:
    """Some seeds of one variant to a task, so that they share what is prepared; the first task is
    a single run."""
    stride = min(len(seeds), workers * _CHUNKS)
    (variant, some), *others = [
        (variant, seeds[first::stride])
        for first in range(stride)
        for variant in experiment.variants
    ]
    parts = (some[:1], some[1:])
    return [*((variant, part) for part in parts if part), *others]


def _run_seeds(experiment: Experiment, task: Task) -> list[Metrics]:
    variant, seeds = task
    allow(experiment.variant_spec(variant).run_limits())
    with experiment.prepare(variant) as prepared:
        return [_metrics(prepared, seed) for seed in seeds]


def _run_apart(experiment: Experiment, task: Task) -> list[Metrics]:
    """Every run in a worker of its own: one that dies loses its own loop only."""
    variant, seeds = task
    return [_run_one(experiment, variant, seed) for seed in seeds]


def _run_one(experiment: Experiment, variant: str, seed: int) -> Metrics:
    try:
        return dict(experiment.run(variant, seed=seed).metrics)
    except HarnessError as fault:
        if fault.result is None:
            raise
        warnings.warn(f"{experiment.label(variant)}, seed {seed}: {fault}", stacklevel=2)
        return {LOST: 1.0}


def _metrics(prepared: PreparedVariant, seed: int) -> Metrics:
    try:
        return dict(prepared.run(seed=seed).metrics)
    except HarnessError as fault:
        if fault.result is None:
            raise
        return {LOST: 1.0}  # a run that ends early is a lost loop without further metrics


def study_tables(experiment: Experiment, study: Study) -> list[Table]:
    """Means, paired differences to the baseline with intervals, and shares of lost loops."""
    spec = experiment.spec.study
    assert spec is not None
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
            f"{lost.share:.0%} [{lost.low:.0%}, {lost.high:.0%}]",
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
    return f"{d.mean:+.3g} [{d.low:+.3g}, {d.high:+.3g}]"
