"""Signals of a run as surfaces over two others, as for a map that a run has swept.

The rows are scattered points (x, y, z); time plays no part. They are joined by Delaunay triangles,
so the sweep may take any path that covers the plane, and z is interpolated linearly between them.

This module refuses to know what swept the plane.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from harness.errors import UsageError
from harness.results.plots import axis_label, new_figure, quantity
from harness.results.result import Result

COLUMNS, PANEL = 2, 4.2
VIEW = (25.0, -125.0)
"""Elevation and azimuth of the eye, in degrees."""


def surfaces_plot(
    result: Result, over: tuple[str, str], signals: Sequence[str], *, title: str = ""
) -> Figure:
    """One panel a signal, over the plane of the two signals `over`.

    Raises `UsageError` where these two do not span a plane, since no surface stands on a line.
    """
    x, y = (result.numbers(name) for name in over)
    spread = np.linalg.svd(np.array([x - np.mean(x), y - np.mean(y)]), compute_uv=False)
    if not (np.all(np.isfinite(spread)) and spread[1] > 1e-6 * spread[0]):
        raise UsageError(
            f"{over[0]!r} and {over[1]!r} move along a line in this run; a surface needs both of "
            "them swept"
        )
    rows = -(-len(signals) // COLUMNS)
    columns = min(len(signals), COLUMNS)
    size = (PANEL * columns + 0.6, 0.85 * PANEL * rows + 0.6)
    figure = new_figure(size, title)
    for place, name in enumerate(signals, 1):
        axes: Any = figure.add_subplot(rows, columns, place, projection="3d")
        z = result.numbers(name)
        axes.plot_trisurf(x, y, z, cmap="viridis", linewidth=0.0, antialiased=True)
        axes.view_init(*VIEW)
        axes.set_xlabel(_named(result, over[0]))
        axes.set_ylabel(_named(result, over[1]))
        axes.set_title(_named(result, name), fontsize="medium")
    return figure


def _named(result: Result, name: str) -> str:
    return axis_label(quantity(name), result.unit(name))
