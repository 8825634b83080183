"""What people look at after a run: a table of metrics and pictures, written beside the rows."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure
from rich import box
from rich.table import Table

from harness.errors import ExperimentError
from harness.experiment.experiment import Experiment
from harness.experiment.schema import PlotSpec
from harness.process.side_by_side import Tell, at_once, side_by_side
from harness.results.atomic import atomic_write, writing
from harness.results.membership_plot import membership_plot
from harness.results.plots import gains_plot, overview_plot, save_figure
from harness.results.result import Result
from harness.results.step_response import metric_units
from harness.results.surface_plot import surfaces_plot

Results = Mapping[str, Result]

SHOWN = {
    "delay_time": "delay",
    "rise_time": "rise",
    "overshoot": "overshoot",
    "settling_time": "settling",
    "steady_state_mean": "SSE mean",
    "steady_state_rms": "SSE RMS",
    "iae": "IAE",
    "actuator_travel": "travel",
    "lost_loop": "loop",
}
"""The metrics of the table on the terminal, as it calls them; all are in `metrics.csv`."""


def metrics_table(experiment: Experiment, results: Results) -> Table:
    """One row a variant; "–" where a figure does not exist, as for a loop that never settles.
    First what is measured of a control loop, where there is one, then the figures that any variant
    defines itself."""
    measured = experiment.spec.measure is not None
    title = "metrics of the last step of the reference" if measured else "metrics"
    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD)
    table.add_column("variant")
    units = _units(experiment, results)
    specs = [experiment.variant_spec(variant) for variant in results]
    own = {name: name.replace("_", "\n") for spec in specs for name in spec.metrics}
    shown = SHOWN | own if measured else own
    for name, heading in shown.items():
        unit = "" if name == "lost_loop" else units.get(name, "")
        table.add_column(f"{heading}\n{unit}", justify="right", no_wrap=True)
    for variant, result in results.items():
        cells = [show(name, result.metrics.get(name)) for name in shown]
        table.add_row(experiment.label(variant), *cells)
    return table


def signals_table(experiment: Experiment, results: Results) -> Table:
    """One row a signal and variant, for experiments without metrics: how far it went."""
    table = Table(title="recorded signals", title_justify="left", box=box.SIMPLE_HEAD)
    for heading in ("variant", "signal", "unit"):
        table.add_column(heading)
    for heading in ("first", "least", "greatest", "last"):
        table.add_column(heading, justify="right")
    for variant, result in results.items():
        for name in result.numeric:
            values = result.numbers(name)
            if len(values):
                figures = (values[0], values.min(), values.max(), values[-1])
                cells = [f"{one:.6g}" for one in figures]
                table.add_row(experiment.label(variant), name, result.unit(name), *cells)
    return table


def show(name: str, value: float | None) -> str:
    """A figure in four digits, or "–"; in words whether the loop was lost."""
    if value is None:
        return "–"
    if name == "lost_loop":
        return "lost" if value else "kept"
    return f"{value:.4g}"


def write_report(experiment: Experiment, results: Results, folder: Path) -> list[Path]:
    """Pictures and `metrics.csv` in `folder`; returns what was written."""
    with writing(f"the report cannot be written to {folder}", folder):
        written = _draw(folder, figures(experiment, results))
        written.append(_write_metrics(experiment, results, folder / "metrics.csv"))
    return written


Drawing = Callable[[], Figure]


def _draw(folder: Path, drawings: Mapping[str, Drawing]) -> list[Path]:
    """Draw and save pictures, each on a core of its own where there are several."""

    def work(name: str, _: Tell) -> Path:
        return save_figure(folder / f"{name}.png", drawings[name]())

    works = [partial(work, name) for name in drawings]
    if at_once(len(works)) < 2:
        return [one(print) for one in works]
    paths = []
    for ended in side_by_side(works, print):
        if ended.fault is not None:
            raise ended.fault
        paths.append(ended.value)
    return paths


def figures(experiment: Experiment, results: Results) -> dict[str, Drawing]:
    """How to draw the overview of what is measured, and the pictures that the experiment asks
    for."""
    results = {name: result for name, result in results.items() if len(result.time) > 1}
    if not results:
        return {}
    labelled = {experiment.label(name): result for name, result in results.items()}
    spec, title = experiment.spec, experiment.spec.title
    drawn: dict[str, Drawing] = {}
    if spec.measure is not None:
        m = spec.measure
        some = {experiment.label(v): r for v, r in results.items() if v in (m.variants or results)}
        drawn["response"] = partial(
            overview_plot, some or labelled, m.response, m.reference, m.control, title=title
        )
    elif not spec.plots:
        for name, result in results.items():  # a label would make a poor file name
            drawn[name] = partial(result.plot, title=f"{title}\n{experiment.label(name)}")
    for name, plot in spec.plots.items():
        chosen = {
            experiment.label(v): results[v] for v in (plot.variants or results) if v in results
        }
        if plot.membership is not None:
            drawn |= _membership(experiment, results, name, plot)
            continue
        signals = [s for s in plot.signals if any(s in result for result in chosen.values())]
        title_of_plot = plot.title or title
        if signals and plot.over is not None:
            first = next(iter(chosen.values()))
            drawn[name] = partial(surfaces_plot, first, plot.over, signals, title=title_of_plot)
        elif signals:
            drawn[name] = partial(gains_plot, chosen, signals, title=title_of_plot)
    return drawn


def _membership(
    experiment: Experiment, results: Results, name: str, plot: PlotSpec
) -> dict[str, Drawing]:
    """Membership functions of a controller at the first and the last row, a figure an axis."""
    variant = next((v for v in (plot.variants or results) if v in results), None)
    if variant is None:
        return {}
    component, result = plot.membership or "", results[variant]
    controller = experiment.bench(variant).controllers.get(component)
    if controller is None or not hasattr(controller, "membership_curves"):
        raise ExperimentError(
            f"{experiment.path}: plots.{name}.membership: component {component!r} of variant "
            f"{variant!r} has no membership functions that change"
        )
    own = [name for name in result.numeric if name.startswith(f"{component}.")]
    before, after = (
        controller.membership_curves(
            {n.removeprefix(f"{component}."): float(result.numbers(n)[row]) for n in own}
        )
        for row in (0, -1)
    )
    title = plot.title or experiment.spec.title
    return {
        f"{name}_{axis}": partial(
            membership_plot, before[axis], after[axis], title=f"{title}: {axis}"
        )
        for axis in before
    }


def _units(experiment: Experiment, results: Results) -> dict[str, str]:
    m = experiment.spec.measure
    first = next(iter(results.values()), None)
    if m is None or first is None:
        return {}
    return metric_units(first.unit(m.response), first.unit(m.control))


def _write_metrics(experiment: Experiment, results: Results, path: Path) -> Path:
    units = _units(experiment, results)
    with atomic_write(path) as partial, partial.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["variant", "metric", "value", "unit"])
        for variant, result in results.items():
            for name, value in result.metrics.items():
                text = "" if value is None else repr(value)
                writer.writerow([variant, name, text, units.get(name.rpartition("/")[2], "")])
    return path
