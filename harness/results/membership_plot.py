"""Pictures of membership functions, before and after they were tuned."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from harness.errors import UsageError
from harness.results.plots import PALETTE, axis_label, legend_of_all, panels

Array = NDArray[np.float64]
_BEFORE: dict[str, Any] = {"linestyle": (0, (3, 2)), "linewidth": 1.0}
_AFTER: dict[str, Any] = {"linewidth": 1.8}


@dataclass(frozen=True, eq=False)
class MembershipCurves:
    """The membership functions of one variable, drawn: `grid` (shape (n,), in `unit`) and for
    each linguistic term its degrees of membership on the grid."""

    variable: str
    unit: str
    grid: Array
    terms: Mapping[str, Array]


def membership_plot(
    before: Sequence[MembershipCurves], after: Sequence[MembershipCurves], *, title: str = ""
) -> Figure:
    """Membership functions before (thin, dashed) and after (solid), a panel a variable, each term
    in its colour."""
    if [one.variable for one in before] != [one.variable for one in after] or not before:
        raise UsageError("membership functions before and after must be of the same variables")
    figure, axes = panels(len(before), title, shared=False)
    for old, new, panel in zip(before, after, axes, strict=True):
        for index, term in enumerate(old.terms):
            color = PALETTE[index % len(PALETTE)]
            for curves, when, style in ((old, "before", _BEFORE), (new, "after", _AFTER)):
                degrees, label = support(curves.terms[term]), f"{term} {when}"
                panel.plot(curves.grid, degrees, label=label, color=color, **style)
        panel.set_xlabel(axis_label(old.variable, old.unit))
        panel.set_ylabel(axis_label("degree of membership", "1"))
        panel.set_ylim(-0.03, 1.05)
    legend_of_all(figure, axes, columns=max(len(one.terms) for one in before))
    figure.align_ylabels()
    return figure


def support(degrees: Array) -> Array:
    """The degrees where they are not 0, with the zeros beside them; NaN elsewhere, so that no
    term draws over the others along the axis."""
    near = degrees > 0.0
    near[1:] |= degrees[:-1] > 0.0
    near[:-1] |= degrees[1:] > 0.0
    return np.where(near, degrees, np.nan)
