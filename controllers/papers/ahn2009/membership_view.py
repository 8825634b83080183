"""The membership functions of a fuzzy PID as curves to draw, from its parameters θ (34).

This module refuses to draw: it gives grids and degrees of membership to whoever does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array
from controllers.fuzzy.membership import TRIANGULAR, membership

_POINTS = 1001
_SINGLETON = 0.004  # half-width with which a weight is drawn


@dataclass(frozen=True, eq=False)
class Curves:
    """The functions of one variable: `grid` (n,), and per linguistic term its degrees (n,)."""

    variable: str
    unit: str
    grid: Array
    terms: dict[str, Array]


def axis_curves(
    theta: Array, classes: tuple[int, ...], labels: tuple[str, ...], output: str
) -> tuple[Curves, ...]:
    """Curves of one axis: |e|, |de/dt| with `classes` triangles each, and the output weights.

    `theta` is (34): centre, left and right half-width of each triangle, input by input, then the
    weights. Inputs are scaled to [0, 1]; weights are drawn as narrow spikes.
    """
    grid = np.linspace(0.0, 1.0, _POINTS)
    curves, at = [], 0
    for name, count in zip(("scaled |e|", "scaled |de/dt|"), classes, strict=True):
        triangles = theta[at : at + 3 * count].reshape(count, 3)
        at += 3 * count
        curves.append(Curves(name, "1", grid, _drawn(triangles, grid, labels)))
    spikes = np.array([[w, _SINGLETON, _SINGLETON] for w in theta[at:]])
    curves.append(Curves(output, "1", grid, _drawn(spikes, grid, labels)))
    return tuple(curves)


def _drawn(triangles: Array, grid: Array, labels: tuple[str, ...]) -> dict[str, Array]:
    return {
        labels[j] if j < len(labels) else str(j + 1): np.array(
            [membership(TRIANGULAR, float(x), q) for x in grid]
        )
        for j, q in enumerate(triangles)
    }
