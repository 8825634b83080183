"""Pictures of runs, with matplotlib's object interface: nothing global is touched.

Each variant (controller) keeps one colour and one line style in all pictures of a set, by its
place in the mapping; colours are those of Okabe and Ito, which colour-blind readers can tell
apart, and line styles tell them apart in grey. Every axis states its unit. Each function returns
a Figure, which the caller saves (`save_figures`) or shows.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from harness.errors import RecordingError, UsageError
from harness.results.atomic import atomic_write
from harness.results.columns import Trajectory

Variants = Mapping[str, Trajectory]

PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442")
LINE_STYLES: tuple[Any, ...] = ("-", (0, (6, 1.5)), (0, (4, 1.5, 1, 1.5)), (0, (1.5, 1)))
REFERENCE_STYLE: dict[str, Any] = {"color": "black", "linestyle": (0, (3, 2)), "linewidth": 1.1}
STEPS: dict[str, Any] = {"drawstyle": "steps-post"}
WIDTH, PANEL_HEIGHT, DPI = 8.0, 2.3, 130
MOST_CURVES = 5
_LEGEND: dict[str, Any] = {"frameon": False, "fontsize": "small", "borderaxespad": 0.2}
_LINE = 100  # letters that fit above a panel


def line_style(index: int) -> dict[str, Any]:
    """Colour, line style and width of variant number `index`, the same in every picture."""
    return {
        "color": PALETTE[index % len(PALETTE)],
        "linestyle": LINE_STYLES[index % len(LINE_STYLES)],
        "linewidth": 1.4,
    }


def axis_label(quantity: str, unit: str) -> str:
    """ "force (N)"; the unit 1 is written as a dash, since nothing is measured in ones, and a unit
    that is not known not at all."""
    return f"{quantity} ({'–' if unit == '1' else unit})" if unit else quantity


def panels(
    count: int, title: str, *, height: float = PANEL_HEIGHT, shared: bool = True
) -> tuple[Figure, list[Axes]]:
    """A figure with `count` panels above each other, which share the time axis if it is `shared`:
    light grid, no box at the top and right, no margin along the time."""
    figure = new_figure((WIDTH, 1.1 + height * count), title)
    axes = list(np.atleast_1d(figure.subplots(count, 1, sharex=shared)))
    for one in axes:
        one.grid(visible=True, color="0.88", linewidth=0.6)
        one.set_axisbelow(True)
        one.spines[["top", "right"]].set_visible(False)
        one.margins(x=0.0)
    axes[-1].set_xlabel(axis_label("time", "s"))
    return figure, axes


class Picture(Figure):
    """A figure that a notebook shows as a picture, without pyplot and without magic."""

    def _repr_png_(self) -> bytes:
        file = io.BytesIO()
        self.savefig(file, format="png")
        return file.getvalue()


def new_figure(size: tuple[float, float], title: str) -> Figure:
    """An empty figure of a width and height in inches, which pyplot does not know."""
    figure = Picture(figsize=size, dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    if title:
        figure.suptitle(title, fontsize="large")
    return figure


def legend(axes: Axes) -> None:
    """The legend above the panel, in one row where it fits, so that it hides no curve."""
    labels = axes.get_legend_handles_labels()[1]
    room = _LINE // (max(map(len, labels), default=0) + 8)
    columns = max(1, min(len(labels), room, 5))
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, **_LEGEND)


def overview_plot(
    variants: Variants, response: str, reference: str, control: str, *, title: str = ""
) -> Figure:
    """Above each other, with one legend: the response of every variant over the reference (of the
    first variant), the error reference − response, and the control; what is held between its
    samples is drawn as steps."""
    first = next(iter(_some(variants).values()))
    figure, (top, middle, bottom) = panels(3, title)
    middle.axhline(0.0, color="0.4", linewidth=0.8)
    for index, (name, result) in enumerate(variants.items()):
        style, y = line_style(index) | _held(result, response), result.numbers(response)
        top.plot(result.time, y, label=name, **style)
        middle.plot(result.time, result.numbers(reference) - y, label=name, **style)
        style = line_style(index) | _held(result, control)
        bottom.plot(result.time, result.numbers(control), label=name, **style)
    held = REFERENCE_STYLE | _held(first, reference)
    top.plot(first.time, first.numbers(reference), label="reference", **held)
    top.set_ylabel(axis_label(quantity(response), first.unit(response)))
    middle.set_ylabel(axis_label("error", first.unit(response)))
    bottom.set_ylabel(axis_label(quantity(control), first.unit(control)))
    legend(top)
    figure.align_ylabels()
    return figure


def gains_plot(variants: Variants, signals: Sequence[str], *, title: str = "") -> Figure:
    """Internals over time (gains, weights, covariances), a panel each; a variant that has not
    recorded one is left out of its panel."""
    figure, axes = panels(len(signals), title, height=1.8)
    for signal, panel in zip(signals, axes, strict=True):
        unit = None
        for index, (name, result) in enumerate(_some(variants).items()):
            if signal in result:
                unit = result.unit(signal)
                style = line_style(index) | _held(result, signal)
                panel.plot(result.time, result.numbers(signal), label=name, **style)
        if unit is None:
            raise UsageError(f"no variant recorded {signal!r}; nothing can be drawn of it")
        panel.set_ylabel(axis_label(quantity(signal), unit))
    legend_of_all(figure, axes)
    figure.align_ylabels()
    return figure


def legend_of_all(figure: Figure, axes: Iterable[Axes], columns: int = 5) -> None:
    """One legend below the panels, with each name once, filled column by column."""
    legends = (zip(*one.get_legend_handles_labels(), strict=True) for one in axes)
    found = {name: handle for handle, name in chain.from_iterable(legends)}
    columns = min(max(len(found), 1), columns)
    figure.legend(found.values(), found, loc="outside lower center", ncols=columns, **_LEGEND)


def signals_plot(result: Trajectory, names: Sequence[str], *, title: str = "") -> Figure:
    """The named signals of one run over time, a panel for each unit and at most 5 of its signals;
    what is held is drawn as steps, and what jumps at an event as a jump. Later curves are thinner,
    so that the two ends of a wire are both seen."""
    by_unit: dict[str, list[str]] = {}
    for name in names:
        by_unit.setdefault(result.unit(name), []).append(name)
    if not by_unit:
        raise UsageError("no signal was named and none was recorded: nothing can be drawn")
    groups = [
        (unit, found[first : first + MOST_CURVES])
        for unit, found in by_unit.items()
        for first in range(0, len(found), MOST_CURVES)
    ]
    figure, axes = panels(len(groups), title)
    for (unit, shown), panel in zip(groups, axes, strict=True):
        for index, name in enumerate(shown):
            style = line_style(index) | _held(result, name)
            style["linewidth"] += 0.8 * (len(shown) - 1 - index)  # equal ones show below each other
            panel.plot(result.time, result.numbers(name), label=name, **style)
        panel.set_ylabel(axis_label("value" if len(shown) > 1 else quantity(shown[0]), unit))
        legend(panel)
    figure.align_ylabels()
    return figure


def save_figures(folder: Path, figures: Mapping[str, Figure], suffix: str = ".png") -> list[Path]:
    """Writes each figure as `<name><suffix>` into `folder`; the paths."""
    return [save_figure(folder / (name + suffix), figure) for name, figure in figures.items()]


def save_figure(path: Path, figure: Figure) -> Path:
    """Writes a figure to `path`, whose ending names the format and whose folder is made where
    missing; raises `RecordingError`."""
    if (layout := figure.get_layout_engine()) is not None:  # else all is drawn twice for it
        layout.execute(figure)
        figure.set_layout_engine(None)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(path) as partial:
            figure.savefig(partial)
    except (OSError, ValueError) as fault:
        raise RecordingError(f"cannot write the figure {path}: {fault}") from fault
    return path


def _some(variants: Variants) -> Variants:
    if not variants:
        raise UsageError("no variant was given: nothing can be drawn")
    return variants


def _held(result: Trajectory, name: str) -> dict[str, Any]:
    return {} if result.column(name).continuous else STEPS


def quantity(name: str) -> str:
    """ "actuator.force" reads as "force" beside an axis."""
    return name.rpartition(".")[2].replace("_", " ")
