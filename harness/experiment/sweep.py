"""A sweep: closed-loop runs over a grid of two settings, and the share of points that end well.

Every point is a whole run of the experiment through its FMUs. Rows are kept in memory only, and
runs are spread over processes.
"""

from __future__ import annotations

import copy
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Self

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from harness.errors import ExperimentError, HarnessError, RecordingError, nearest
from harness.experiment.experiment import Experiment, Table
from harness.experiment.parallel import Workers, given_or_one
from harness.experiment.schema import AxisSpec, FmuSpec, SweepSpec
from harness.process.watchdog import allow
from harness.results.atomic import atomic_write
from harness.results.plots import axis_label
from harness.results.result import Result

_CHUNKS = 8  # tasks a process gets, so that progress moves and the load evens out


@dataclass(frozen=True, eq=False)
class Region:
    """The outcome of one variant: `outcome[i, j]` belongs to y value i and x value j; NaN where
    the run ended early, or the figure does not exist."""

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
    workers: Workers | None = None,
    progress: Callable[[float], None] | None = None,
) -> dict[str, Region]:
    """Run the sweep of each variant, spread over `workers`.

    None: one process of its own, as any run has; `Workers(1)` runs in this one. A point that kills
    its process is run again under a supervisor, and lies outside if it does so again.
    """
    spec = _spec(experiment)
    chosen = variants or experiment.variants
    found = {v: np.full((spec.y.count, spec.x.count), np.nan) for v in chosen}
    with given_or_one(workers) as crew:
        stride = min(spec.y.count, crew.count * _CHUNKS)
        tasks = [
            (variant, tuple(range(first, spec.y.count, stride)))
            for first in range(stride)
            for variant in chosen
        ]
        outcomes = crew.spread(
            partial(_rows, experiment), tasks, careful=partial(_rows_apart, experiment)
        )
        for done, ((variant, rows), outcome) in enumerate(outcomes, 1):
            found[variant][list(rows)] = outcome
            if progress is not None:
                progress(done / len(tasks))
    return {variant: Region(variant, spec, outcome) for variant, outcome in found.items()}


def _spec(experiment: Experiment) -> SweepSpec:
    if experiment.spec.sweep is None:
        raise ExperimentError(f"{experiment.path} has no table [sweep]")
    return experiment.spec.sweep


def _rows(experiment: Experiment, task: tuple[str, tuple[int, ...]]) -> NDArray[np.float64]:
    variant, rows = task
    allow(experiment.variant_spec(variant).run_limits())
    count = _spec(experiment).x.count
    with _Points(experiment, variant) as points:
        return np.array([[points.outcome(i, j) for j in range(count)] for i in rows])


def _rows_apart(experiment: Experiment, task: tuple[str, tuple[int, ...]]) -> NDArray[np.float64]:
    """As `_rows`, every run in a worker of its own: one that dies is one point outside."""
    variant, rows = task
    count = _spec(experiment).x.count
    with _Points(experiment, variant, apart=True) as points:
        return np.array([[points.outcome(i, j) for j in range(count)] for i in rows])


class _Points:
    """The points of one variant. What only start values of FMUs tell apart is prepared once,
    unless every run is to be `apart`, in a worker process of its own."""

    def __init__(self, experiment: Experiment, variant: str, *, apart: bool = False) -> None:
        self._apart = apart
        self._experiment, self._variant = experiment, variant
        self._spec = _spec(experiment)
        fmus = experiment.variant_spec(variant).components
        self._places = {
            axis.key: place
            for axis in (self._spec.x, self._spec.y)
            if not apart and (place := _start_value(axis.key, fmus)) is not None
        }
        self._settings: dict[str, float] = {}
        self._moved = experiment
        self._prepared = experiment.prepare(variant)

    def outcome(self, i: int, j: int) -> float:
        """The outcome at y value i and x value j; NaN where the run ended early."""
        spec = self._spec
        values = {spec.x.key: spec.x.values[j], spec.y.key: spec.y.values[i]}
        start_values: dict[str, dict[str, float]] = {}
        for key, (component, variable) in self._places.items():
            start_values.setdefault(component, {})[variable] = values.pop(key)
        seed = self._experiment.spec.seed + (i * spec.x.count + j if spec.own_seeds else 0)
        self._prepare(values)
        try:
            metrics = self._run(seed, start_values).metrics
        except HarnessError as fault:
            if fault.result is None:
                raise
            if self._apart:
                warnings.warn(f"{self._variant}, point ({i}, {j}): {fault}", stacklevel=2)
            return float("nan")
        if spec.outcome not in metrics:
            raise ExperimentError(
                f"{self._experiment.path}: sweep.outcome {spec.outcome!r} is no metric; "
                f"{nearest(spec.outcome, metrics)}"
            )
        found = metrics[spec.outcome]
        return float("nan") if found is None else found

    def _prepare(self, settings: dict[str, float]) -> None:
        if settings != self._settings:
            self._prepared.close()
            moved = _moved(self._experiment, self._variant, settings)
            self._settings, self._prepared = settings, moved.prepare(self._variant)
            self._moved = moved

    def _run(self, seed: int, start_values: dict[str, dict[str, float]]) -> Result:
        if self._apart:
            return self._moved.run(self._variant, seed=seed)
        return self._prepared.run(seed=seed, start_values=start_values)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._prepared.close()


def _start_value(key: str, components: Mapping[str, object]) -> tuple[str, str] | None:
    """The FMU and the variable of a key "components.FMU.start_values.VARIABLE"."""
    match key.split(".", 3):
        case ["components", name, "start_values", variable]:
            return (name, variable) if isinstance(components.get(name), FmuSpec) else None
    return None


def _moved(experiment: Experiment, variant: str, settings: Mapping[str, float]) -> Experiment:
    """The experiment with other settings of one variant."""
    data = copy.deepcopy(experiment.data)
    changes = data
    if experiment.spec.variants:
        changes = data["variants"][variant]
    for key, value in settings.items():
        _set(changes, key, value)
    return Experiment.from_data(data, experiment.path)


def _set(data: Table, key: str, value: float) -> None:
    *tables, last = key.split(".")
    for part in tables:
        data = data.setdefault(part, {})
    data[last] = value


def region_plot(experiment: Experiment, regions: dict[str, Region]) -> Figure:
    """One image a variant: points inside dark, with their share in the title; the number of points
    is in the title of the whole."""
    width = min(len(regions), 3)
    height = -(-len(regions) // width)
    figure = Figure(figsize=(3.4 * width + 0.6, 3.4 * height + 0.6), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    sweep = _spec(experiment)
    figure.suptitle(f"{experiment.spec.title}\ngrid of {sweep.x.count} × {sweep.y.count} points")
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
        with atomic_write(picture) as partial:
            region_plot(experiment, regions).savefig(partial)
        with atomic_write(table) as partial, partial.open("w", encoding="utf-8") as file:
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
