"""A surface shows the values of a signal over two others, whatever path the run took."""

import numpy as np
import pytest

from harness.errors import UsageError
from harness.results.recording import Column, Recording
from harness.results.result import Result
from harness.results.surface_plot import surfaces_plot

COLUMNS = (Column("a.x", "s"), Column("a.y"), Column("a.sum", "N"), Column("a.line"))
STEP = 0.01


def swept() -> Result:
    """x swings while y rises; sum = 2x + 3y; line = 5x."""
    t = np.linspace(0.0, 1.0, 400)
    x, y = np.sin(2.0 * np.pi * 10.0 * t), 2.0 * t - 1.0
    recording = Recording(COLUMNS)
    recording.append(np.arange(400) * STEP, np.column_stack([x, y, 2.0 * x + 3.0 * y, 5.0 * x]))
    return recording.finish()


def test_the_surface_covers_what_the_run_covered() -> None:
    figure = surfaces_plot(swept(), ("a.x", "a.y"), ["a.sum", "a.line"], title="map")
    assert [axes.get_title() for axes in figure.axes] == ["sum (N)", "line (–)"]
    first = figure.axes[0]
    assert (first.get_xlabel(), first.get_ylabel()) == ("x (s)", "y (–)")
    run = swept()
    shown = (*first.xy_dataLim.intervalx, *first.xy_dataLim.intervaly, *first.zz_dataLim.intervalx)
    limits = [edge(run[name]) for name in ("a.x", "a.y", "a.sum") for edge in (np.min, np.max)]
    assert shown == tuple(limits)
    (surface,) = first.collections
    assert len(surface.get_facecolor()) > 400  # triangles; a plane of 400 points has almost 800


@pytest.mark.parametrize("over", [("a.x", "a.line"), ("a.x", "a.x")])
def test_signals_along_a_line_span_no_surface(over: tuple[str, str]) -> None:
    with pytest.raises(UsageError, match="move along a line"):
        surfaces_plot(swept(), over, ["a.sum"])
