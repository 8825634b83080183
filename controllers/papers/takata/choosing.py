"""Automatic choosing functions, (3) of Takata et al., for any number of sections and variables.

A space of L separative variables c is divided into sections, each a box [a_1, b_1] × … × [a_L, b_L]
whose sides may lie at infinity. Section i has the weight

    I_i(c) = Π_j {1 − 1/(1 + exp(2N(c_j − a_ij))) − 1/(1 + exp(−2N(c_j − b_ij)))}

that is, with the logistic function s, Π_j {s(2N(c_j − a_ij)) − s(2N(c_j − b_ij))}: about 1 inside
its box, about 0 outside, and 1/2 on a side shared with a neighbour. **The weights sum to one
everywhere** exactly when the boxes tile the space, which `ChoosingFunctions` demands.

This module refuses to know what is chosen among.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from controllers.core.block import Array
from controllers.core.errors import require, require_positive


def logistic_difference(upper: float, lower: float) -> float:
    """s(upper) − s(lower) with s(z) = 1/(1 + exp(−z)), exact where both are close to 1."""
    if upper > -lower:
        return logistic(-lower) - logistic(-upper)
    return logistic(upper) - logistic(lower)


def logistic(z: float) -> float:
    """1/(1 + exp(−z)) without overflow."""
    if z >= 0.0:
        return 1.0 / (1.0 + math.exp(-z))
    e = math.exp(z)
    return e / (1.0 + e)


def choose(sections: int, variables: int, sharpness: float, sides: Array, c: Array, out: Array
) -> None:  # fmt: skip
    """The weights I_i of all sections at c (variables,), into out (sections,).

    `sides` (2·sections·variables,) holds a_ij, b_ij in turn, sections outermost.
    """
    for i in range(sections):
        weight = 1.0
        for j in range(variables):
            at = 2 * (i * variables + j)
            weight = weight * logistic_difference(
                2.0 * sharpness * (c[j] - sides[at]), 2.0 * sharpness * (c[j] - sides[at + 1])
            )
        out[i] = weight


@dataclass(frozen=True)
class ChoosingFunctions:
    """Sections and the sharpness N of their sides.

    lower, upper  corners (a_i1, …, a_iL) and (b_i1, …, b_iL) of each section; infinite ones too
    sharpness     N [1 over the unit of the separative variables]
    """

    lower: tuple[tuple[float, ...], ...]
    upper: tuple[tuple[float, ...], ...]
    sharpness: float

    def __post_init__(self) -> None:
        """Raise `ControllerError` unless the sections tile the whole space."""
        name = "ChoosingFunctions"
        require_positive(f"{name}.sharpness", self.sharpness)
        for field in ("lower", "upper"):
            corners = tuple(tuple(float(v) for v in corner) for corner in getattr(self, field))
            object.__setattr__(self, field, corners)
        counts = (len(self.lower), len(self.upper))
        require(
            counts[0] == counts[1] >= 1, f"{name}.lower, upper", "as many of both, from 1", counts
        )
        for i, (a, b) in enumerate(zip(self.lower, self.upper, strict=True)):
            expected = f"{self.variables} numbers, each below that of upper"
            legal = len(a) == len(b) == self.variables >= 1
            legal = legal and all(low < high for low, high in zip(a, b, strict=True))
            require(legal, f"{name}: section {i}", expected, (a, b))
        self._require_tiles()

    @property
    def sections(self) -> int:
        """Number of sections."""
        return len(self.lower)

    @property
    def variables(self) -> int:
        """Number L of separative variables."""
        return len(self.lower[0])

    def sections_at(self, c: Sequence[float]) -> list[int]:
        """The sections whose box holds the point c."""
        boxes = zip(self.lower, self.upper, strict=True)
        return [
            i for i, (a, b) in enumerate(boxes)
            if all(low <= v <= high for low, v, high in zip(a, c, b, strict=True))
        ]  # fmt: skip

    def sides(self) -> Array:
        """All sides (sections, variables, 2); `choose` reads them one after the other."""
        return np.stack([self.lower, self.upper], axis=-1).astype(np.float64)

    def weights(self, c: Sequence[float]) -> Array:
        """The weights (sections,) at c (variables,)."""
        out = np.empty(self.sections)
        given = np.asarray(c, dtype=np.float64)
        require(given.shape == (self.variables,), "ChoosingFunctions.weights: c",
                f"{self.variables} numbers", c)  # fmt: skip
        choose(self.sections, self.variables, self.sharpness, self.sides().ravel(), given, out)
        return out

    def _require_tiles(self) -> None:
        """Every cell between neighbouring sides must lie in exactly one section."""
        middles = [
            _middles({corner[j] for corner in (*self.lower, *self.upper)})
            for j in range(self.variables)
        ]
        for point in product(*middles):
            held = self.sections_at(point)
            require(
                len(held) == 1, f"ChoosingFunctions: sections at {point}",
                "exactly one, so that they tile the space", held,
            )  # fmt: skip


def _middles(sides: set[float]) -> list[float]:
    """A point in each interval into which `sides` divide the whole line."""
    finite = sorted(side for side in sides if math.isfinite(side))
    if not finite:
        return [0.0]
    inner = [0.5 * (a + b) for a, b in pairwise(finite)]
    return [finite[0] - 1.0, *inner, finite[-1] + 1.0]
