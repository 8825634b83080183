"""A sweep: closed-loop runs over a grid of two settings, and the share of points that end well.

Every point is a whole run of the experiment through its FMUs. Rows are kept in memory only, and
runs are spread over processes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain, groupby
from pathlib import Path
from textwrap import fill

import numpy as np
import pandas as pd
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from harness.errors import ExperimentError, HarnessError
from harness.experiment.border import explore
from harness.experiment.experiment import Experiment
from harness.experiment.foresight import check_metrics
from harness.experiment.journal import Journal, Metrics, Point
from harness.experiment.parallel import Workers, given_or_one
from harness.experiment.repeated import run_points
from harness.experiment.schema import AxisSpec, SweepSpec
from harness.results.atomic import atomic_write, writing
from harness.results.plots import axis_label, new_figure


@dataclass(frozen=True, eq=False)
class Region:
    """The outcome of one variant: `outcome[i, j]` belongs to y value i and x value j; NaN where
    the run ended early, or the figure does not exist. `ran` are the points that were run, None for
    all. The others have the outcome of a neighbour that is on their side of the border, or, in a
    sweep that ended early (`complete` false), none."""

    variant: str
    spec: SweepSpec
    outcome: NDArray[np.float64]
    ran: NDArray[np.bool_] | None = None
    complete: bool = True

    @property
    def done(self) -> NDArray[np.bool_]:
        """The points of which something is known."""
        all_of_them = self.complete or self.ran is None
        return np.ones(self.outcome.shape, bool) if all_of_them else np.asarray(self.ran)

    @property
    def inside(self) -> NDArray[np.bool_]:
        """The points whose outcome is below the limit."""
        return np.asarray(self.outcome < self.spec.below)

    @property
    def least(self) -> tuple[float, float, float] | None:
        """x, y and outcome of the point with the least outcome; None where none has one."""
        if np.isnan(self.outcome).all():
            return None
        i, j = np.unravel_index(int(np.nanargmin(self.outcome)), self.outcome.shape)
        return self.spec.x.values[j], self.spec.y.values[i], float(self.outcome[i, j])

    @property
    def share(self) -> float:
        """The share of points inside among those done, 0 to 1; NaN where there are none."""
        return float(np.mean(self.inside[self.done])) if self.done.any() else float("nan")


def run_sweep(
    experiment: Experiment,
    variants: tuple[str, ...] | None = None,
    *,
    workers: Workers | None = None,
    progress: Callable[[float], None] | None = None,
    journal: Journal | None = None,
) -> dict[str, Region]:
    """Run the sweep of each variant, spread over `workers`.

    `workers` are as those of `run_points`; a point whose run ends early lies outside. What the
    `journal` has is not run again. A fault, and Ctrl-C, has in `result` the regions as far as they
    were done.
    """
    check_metrics(experiment)
    journal, spec = journal or Journal(), _spec(experiment)
    chosen = variants or spec.variants or experiment.variants
    shape = (spec.y.count, spec.x.count)
    levels = spec.spacing.bit_length()

    def run(places: Sequence[tuple[int, int]], done: float) -> NDArray[np.float64]:
        rows = [
            [_point(experiment, spec, i, j) for i, j in row]
            for _, row in groupby(places, key=lambda place: place[0])
        ]
        moved = None if progress is None else partial(_move, progress, done, levels)
        run_points(experiment, chosen, rows, journal, workers=crew, progress=moved)
        return np.array(
            [[_outcome(experiment, journal, v, p) for p in chain(*rows)] for v in chosen]
        )

    try:
        with given_or_one(workers) as crew:
            outcome, ran = explore(shape, spec.spacing, run, lambda values: values < spec.below)
    except (KeyboardInterrupt, HarnessError) as fault:
        fault.result = sweep_so_far(experiment, chosen, journal)  # type: ignore[union-attr]
        raise
    return {v: Region(v, spec, outcome[k], ran) for k, v in enumerate(chosen)}


def sweep_so_far(
    experiment: Experiment, variants: Sequence[str], journal: Journal
) -> dict[str, Region]:
    """The regions of a sweep that ended early."""
    spec, found = _spec(experiment), {}
    points = [
        [_point(experiment, spec, i, j) for j in range(spec.x.count)] for i in range(spec.y.count)
    ]
    for v in variants:
        outcome = [[_outcome(experiment, journal, v, point) for point in row] for row in points]
        ran = [[(v, point) in journal.found for point in row] for row in points]
        found[v] = Region(v, spec, np.array(outcome), np.array(ran), complete=False)
    return found


def _move(progress: Callable[[float], None], done: float, levels: int, share: float) -> None:
    progress(done + share / levels)


def _spec(experiment: Experiment) -> SweepSpec:
    if experiment.spec.sweep is None:
        raise ExperimentError(f"{experiment.path} has no table [sweep]")
    return experiment.spec.sweep


def _point(experiment: Experiment, spec: SweepSpec, i: int, j: int) -> Point:
    """The run at y value i and x value j."""
    first = experiment.spec.seed if spec.seed is None else spec.seed
    seed = first + (i * spec.x.count + j if spec.own_seeds else 0)
    settings = ((spec.x.key, spec.x.values[j]), (spec.y.key, spec.y.values[i]))
    return Point(f"point ({i}, {j})", seed, settings)


def _outcome(experiment: Experiment, journal: Journal, variant: str, point: Point) -> float:
    """The outcome of a point; NaN where the run ended early, was not run, or the figure does not
    exist."""
    metrics: Metrics = journal.found.get((variant, point)) or {}
    found = metrics.get(_spec(experiment).outcome)
    return float("nan") if found is None else found


def region_plot(experiment: Experiment, regions: dict[str, Region]) -> Figure:
    """One image a variant: points inside dark, with their share in the title; the number of points
    is in the title of the whole."""
    width = min(len(regions), 3)
    height = -(-len(regions) // width)
    sweep = _spec(experiment)
    wrapped = fill(experiment.spec.title, 18 * (width + 1))
    title = f"{wrapped}\ngrid of {sweep.x.count} × {sweep.y.count} points"
    figure = new_figure((3.4 * width + 0.6, 3.4 * height + 0.6), title)
    panels = figure.subplots(height, width, squeeze=False).ravel()
    for panel in panels[len(regions) :]:
        panel.set_visible(False)
    for panel, (variant, region) in zip(panels, regions.items(), strict=False):
        x, y = region.spec.x, region.spec.y
        panel.pcolormesh(
            x.values, y.values, region.inside, cmap=ListedColormap(["#e8e8e8", "#0072b2"]),
            vmin=0, vmax=1, shading="nearest",
        )  # fmt: skip
        panel.set_title(f"{experiment.label(variant)}: {100 * region.share:.1f} %", fontsize=10)
        panel.set_xlabel(_axis(x))
        panel.set_ylabel(_axis(y))
    return figure


def _axis(axis: AxisSpec) -> str:
    return axis.label or axis_label(axis.key.rpartition(".")[2], "")


def write_sweep(experiment: Experiment, regions: dict[str, Region], folder: Path) -> list[Path]:
    """`regions.png` and `regions.csv` (variant, x, y, outcome, inside, ran) in `folder`."""
    picture, table = folder / "regions.png", folder / "regions.csv"
    points = pd.DataFrame(
        {"variant": variant, "x": x, "y": y, "outcome": region.outcome[i, j],
         "inside": int(region.inside[i, j]),
         "ran": int(region.ran is None or region.ran[i, j])}
        for variant, region in regions.items()
        for i, y in enumerate(region.spec.y.values)
        for j, x in enumerate(region.spec.x.values)
        if region.done[i, j]
    )  # fmt: skip
    with writing(f"the sweep cannot be written to {folder}", folder):
        with atomic_write(picture) as part:
            region_plot(experiment, regions).savefig(part)
        with atomic_write(table) as part:
            points.to_csv(part, index=False, na_rep="nan")
    return [picture, table]
