"""Central differences, extrapolated after Ridders: the step is halved and powers of it cancelled.

The estimate of each component is the entry of its tableau that differs least from its neighbours,
so neither truncation nor rounding has to be guessed.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
HALVINGS = 12


def derivative(function: Callable[[float], Array], size: float) -> Array:
    """d function(z)/dz at z = 0, with steps of `size` and below.

    A step that leaves the function's domain (NaN) takes no part.
    """
    best, doubt = np.array(np.nan), np.array(np.inf)
    above: list[Array] = []
    for k in range(HALVINGS):
        step = size / 2**k
        row = [(function(step) - function(-step)) / (2 * step)]
        for order, coarser in enumerate(above, 1):
            row.append((4**order * row[-1] - coarser) / (4**order - 1))
            change = np.fmax(np.abs(row[-1] - row[-2]), np.abs(row[-1] - coarser))
            change = np.where(np.isfinite(row[-1]), change, np.inf)
            best, doubt = np.where(change < doubt, row[-1], best), np.minimum(change, doubt)
        above = row
    return best
