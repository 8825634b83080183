"""The form of the generated equations in a portable FMU."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Vector = list[float]


@dataclass(frozen=True)
class Model:
    """Tables and functions of one plant, `names` by value reference.

    `outputs` is of (x, u, p), derivatives and linearise are of (x, u, p, invariants(u, p)).
    `linearise` returns dx and the nonzeros of df/dx by columns; `factorise` of those nonzeros and
    [d] the factors of d·I − df/dx, the inverses of its pivots first; `solve` of factors and right
    side the solution.
    """

    names: tuple[str, ...]
    state_names: tuple[str, ...]
    x_start: tuple[float, ...]
    x_nominal: tuple[float, ...]
    u_start: tuple[float, ...]
    p_start: tuple[float, ...]
    p_range: tuple[tuple[float, float], ...]
    p_tunable: tuple[bool, ...]
    n_outputs: int
    state_jacobian_rows: tuple[int, ...]
    relative_tolerance: float
    invariants: Callable[[Vector, Vector], Vector]
    derivatives: Callable[[Vector, Vector, Vector, Vector], Vector]
    outputs: Callable[[Vector, Vector, Vector], Vector]
    linearise: Callable[[Vector, Vector, Vector, Vector], tuple[Vector, Vector]]
    factorise: Callable[[Vector, Vector], Vector]
    solve: Callable[[Vector, Vector], Vector]
