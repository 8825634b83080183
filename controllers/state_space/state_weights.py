"""Weights of a linear-quadratic cost, as settings give them: a diagonal, or a whole matrix."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from controllers.core.block import Array
from controllers.core.errors import require

Weights = Sequence[float] | Sequence[Sequence[float]]


def weight_matrix(where: str, given: Weights, size: int) -> Array:
    """The matrix (size, size) that `given` means; raises `ControllerError` for another shape."""
    array = np.asarray(given, dtype=np.float64)
    legal = array.shape in ((size,), (size, size))
    require(legal, where, f"{size} diagonal elements or a {size} × {size} matrix", given)
    return np.diag(array) if array.ndim == 1 else array
