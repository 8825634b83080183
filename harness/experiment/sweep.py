"""A sweep: closed-loop runs over a grid of two settings, and the share of points that end well.

Every point is a whole run of the experiment through its FMUs. Rows are kept in memory only, and
runs are spread over processes.
"""

from __future__ import annotations

import copy
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from harness.errors import ExperimentError, HarnessError, RecordingError
from harness.experiment.experiment import Experiment, Table
from harness.experiment.parallel import spread
from harness.experiment.schema import AxisSpec, SweepSpec
from harness.results.plots import axis_label

_CHUNKS = 8  # tasks a process gets, so that progress moves and the load evens out


@dataclass(frozen=True, eq=False)
class Region:
    """The outcome of one variant: `outcome[i, j]` belongs to y value i and x value j; NaN where
    the run ended early."""

    variant: str
    spec: SweepSpec
    outcome: NDArray[np.float64]

    @property
    def inside(self) -> NDArray[np.bool_]:
        """The points whose outcome is below the limit."""
        return np.asarray(self.outcome < self.spec.below)

    @property
    def share(self) -> float:
        """The share of points inside, 0 to 1."""
        return float(np.mean(self.inside))


def run_sweep(
    experiment: Experiment,
    variants: tuple[str, ...] | None = None,
    *,
    jobs: int = 0,
    progress: Callable[[float], None] | None = None,
) -> dict[str, Region]:
    """Run the sweep of each variant in `jobs` processes (0: one a core)."""
    spec = experiment.spec.sweep
    if spec is None:
        raise ExperimentError(f"{experiment.path} has no table [sweep]")
    chosen = variants or experiment.variants
    for variant in chosen:
        _point(experiment, variant, 0, 0)  # builds and compiles once
    workers = jobs or os.cpu_count() or 1
    stride = min(spec.y.count, workers * _CHUNKS)
    tasks = [
        (variant, tuple(range(first, spec.y.count, stride)))
        for variant in chosen
        for first in range(stride)
    ]
    found = {v: np.full((spec.y.count, spec.x.count), np.nan) for v in chosen}
    outcomes = spread(partial(_rows, experiment), tasks, workers)
    for done, ((variant, rows), outcome) in enumerate(outcomes, 1):
        found[variant][list(rows)] = outcome
        if progress is not None:
            progress(done / len(tasks))
    return {variant: Region(variant, spec, outcome) for variant, outcome in found.items()}


def _rows(experiment: Experiment, task: tuple[str, tuple[int, ...]]) -> NDArray[np.float64]:
    variant, rows = task
    spec = experiment.spec.sweep
    assert spec is not None
    return np.array(
        [[_point(experiment, variant, i, j) for j in range(spec.x.count)] for i in rows]
    )


def _point(experiment: Experiment, variant: str, i: int, j: int) -> float:
    spec = experiment.spec.sweep
    assert spec is not None
    data = copy.deepcopy(experiment.data)
    changes = (
        data.setdefault("variants", {}).setdefault(variant, {})
        if experiment.spec.variants
        else data
    )
    for axis, value in ((spec.x, spec.x.values[j]), (spec.y, spec.y.values[i])):
        _set(changes, axis.key, value)
    moved = Experiment.from_data(data, experiment.path)
    seed = moved.spec.seed + (i * spec.x.count + j if spec.own_seeds else 0)
    try:
        outcome = moved.run(variant, seed=seed).metrics.get(spec.outcome)
    except HarnessError as fault:
        if fault.result is None:
            raise
        return float("nan")
    if outcome is None:
        raise ExperimentError(f"{experiment.path}: sweep.outcome {spec.outcome!r} is no metric")
    return outcome


def _set(data: Table, key: str, value: float) -> None:
    *tables, last = key.split(".")
    for part in tables:
        data = data.setdefault(part, {})
    data[last] = value


def region_plot(experiment: Experiment, regions: dict[str, Region]) -> Figure:
    """One image a variant: points inside dark, with their share in the title."""
    width = min(len(regions), 3)
    height = -(-len(regions) // width)
    figure = Figure(figsize=(3.4 * width + 0.6, 3.4 * height + 0.6), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(experiment.spec.title)
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
    """`regions.png` and `regions.csv` (variant, x, y, outcome, inside) in `folder`."""
    picture, table = folder / "regions.png", folder / "regions.csv"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        region_plot(experiment, regions).savefig(picture)
        with table.open("w", encoding="utf-8") as file:
            file.write("variant,x,y,outcome,inside\n")
            for variant, region in regions.items():
                for i, y in enumerate(region.spec.y.values):
                    for j, x in enumerate(region.spec.x.values):
                        inside = int(region.inside[i, j])
                        outcome = float(region.outcome[i, j])
                        file.write(f"{variant},{x!r},{y!r},{outcome!r},{inside}\n")
    except OSError as fault:
        raise RecordingError(f"the sweep cannot be written to {folder}: {fault}") from fault
    return [picture, table]
