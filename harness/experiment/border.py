"""A map by its border: a grid is run coarsely, then finer only where neighbours differ.

The points of a square grid whose corners are all on one side, and all of whose neighbours are so
too, are taken to be on that side; all others are run. A part of a region that lies wholly between
coarse points, more than a square away from the border, is not found.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Grid = NDArray[np.bool_]
Values = NDArray[np.float64]
Place = tuple[int, int]


def explore(
    shape: tuple[int, int],
    spacing: int,
    run: Callable[[Sequence[Place], float], Values],
    inside: Callable[[Values], Grid],
) -> tuple[Values, Grid]:
    """The outcomes of several variants over a grid of `shape` (rows n, columns m), and which of
    its points were run.

    First every `spacing`-th row and column is run (a power of 2 that divides n − 1 and m − 1), then
    half of that near the border, down to 1. `run` is given the places (row, column) in order, and
    the share of the levels that are done; it returns the outcomes, shape (variants, places). A
    point is run for all variants where it is for one. What is not run has the outcome of the corner
    below it. The outcomes have shape (variants, n, m).
    """
    levels = spacing.bit_length()
    ran = np.zeros(shape, dtype=bool)
    wanted = _lattice(shape, spacing)
    outcome: Values = np.empty((0, *shape))
    for level in range(levels):
        places = [(int(i), int(j)) for i, j in np.argwhere(wanted & ~ran)]
        if places:
            found = run(places, level / levels)
            outcome = outcome if level else np.empty((len(found), *shape))
            outcome[:, *np.transpose(places)] = found
            ran[*np.transpose(places)] = True
        if spacing > 1:
            wanted = _near_border(inside(outcome[:, ::spacing, ::spacing]), shape, spacing)
            spacing //= 2
            _fill(outcome, _lattice(shape, spacing) & ~ran & ~wanted, 2 * spacing)
    return outcome, ran


def _lattice(shape: tuple[int, int], spacing: int) -> Grid:
    points = np.zeros(shape, dtype=bool)
    points[::spacing, ::spacing] = True
    return points


def _near_border(corners: Grid, shape: tuple[int, int], spacing: int) -> Grid:
    """The points at half of `spacing` in squares that the border crosses, for any variant, and in
    their neighbours."""
    around = (corners[:, :-1, :-1], corners[:, :-1, 1:], corners[:, 1:, :-1], corners[:, 1:, 1:])
    crossed = np.any(np.any(around, axis=0) != np.all(around, axis=0), axis=0)
    points, half = np.zeros(shape, dtype=bool), spacing // 2
    for row, column in np.argwhere(crossed):
        top, left = max(row - 1, 0) * spacing, max(column - 1, 0) * spacing
        points[top : (row + 2) * spacing + 1 : half, left : (column + 2) * spacing + 1 : half] = (
            True
        )
    return points


def _fill(outcome: Values, points: Grid, spacing: int) -> None:
    """Give `points` the outcome of the corner of their square, which all of its corners share."""
    i, j = np.nonzero(points)
    outcome[:, i, j] = outcome[:, i - i % spacing, j - j % spacing]
