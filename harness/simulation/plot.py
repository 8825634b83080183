"""A picture of a simulation: one panel a unit, legends, everything that is held drawn as steps."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from harness.errors import RecordingError
from harness.results.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MOST_CURVES = 5
_LINE = 100  # letters that fit above a panel


def simulation_plot(result: Result, title: str = "") -> Figure:
    """The recorded numbers over time (s); at most 5 curves a panel, and a panel a unit."""
    from harness.results.plots import axis_label, line_style, panels

    groups = _panels(result)
    figure, axes = panels(len(groups), title)
    for (unit, names), panel in zip(groups, axes, strict=True):
        for index, name in enumerate(names):
            held = not result.column(name).continuous
            style = line_style(index) | ({"drawstyle": "steps-post"} if held else {})
            panel.plot(result.time, result.numbers(name), label=name, **style)
        panel.set_ylabel(axis_label(names[0] if len(names) == 1 else "value", unit))
        _legend(panel, names)
    figure.align_ylabels()
    return figure


def _legend(panel: Axes, names: list[str]) -> None:
    """Above the panel, in as many columns as the names leave room for."""
    columns = max(1, min(len(names), _LINE // (max(map(len, names)) + 8)))
    panel.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.05), ncols=columns, frameon=False,
        fontsize="small", borderaxespad=0.2,
    )  # fmt: skip


def _panels(result: Result) -> list[tuple[str, list[str]]]:
    by_unit: dict[str, list[str]] = {}
    for name in [c.name for c in result.columns if c.dtype is not None]:
        by_unit.setdefault(result.unit(name), []).append(name)
    return [
        (unit, names[first : first + _MOST_CURVES])
        for unit, names in by_unit.items()
        for first in range(0, len(names), _MOST_CURVES)
    ]


def write_plot(result: Result, path: Path) -> None:
    """Draw `result` into `path`, whose ending names the format; raises `RecordingError`."""
    record = result.manifest.fmus[0]
    kind = result.manifest.experiment.get("interface_type", "")
    figure = simulation_plot(result, f"{record.instance} ({kind})")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path)
    except (OSError, ValueError) as fault:
        raise RecordingError(f"cannot write the figure {path}: {fault}") from fault
