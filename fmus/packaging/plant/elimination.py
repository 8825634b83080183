"""Gaussian elimination of d·I − J as straight-line expressions, by the sparsity of J.

    (d·I − J) z = b        J = df/dx with a known pattern, d = 1/(hγ) > 0

Which entries exist is known when an FMU is made, so the generated code has no loops, indices or
structural zeros. Pivots stay on the diagonal, in an order that keeps fill-in low (Markowitz 1957);
they are near d where the substep resolves the model, and whoever factorises must refuse a pivot far
below d. On the diagonal the units of states cancel.

This module refuses to know plants, solvers and languages.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

Entry = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Elimination:
    """CasADi functions: `factorise` of (nonzeros of J by columns, d) yields `n_factors` numbers,
    the inverses of the n pivots first; `solve` of (factors, b) yields z."""

    factorise: Any
    solve: Any
    n_factors: int


def elimination(sparsity: Any) -> Elimination:
    """The elimination for a square pattern (casadi.Sparsity)."""
    n = sparsity.size1()
    slopes, diagonal = ca.SX.sym("slopes", sparsity.nnz()), ca.SX.sym("diagonal")
    matrix: dict[Entry, Any] = {(i, i): diagonal for i in range(n)}
    for k, (i, j) in enumerate(zip(sparsity.row(), sparsity.get_col(), strict=True)):
        matrix[i, j] = matrix[i, j] - slopes[k] if i == j else -slopes[k]
    order = _pivot_order(n, set(matrix))
    pivots = _factorise(matrix, order)
    places = [entry for entry in sorted(matrix) if entry[0] != entry[1]]
    values = [pivots[i] for i in range(n)] + [matrix[entry] for entry in places]
    factors = ca.SX.sym("factors", len(values))
    of_entry = {entry: factors[n + k] for k, entry in enumerate(places)}
    right = ca.SX.sym("right", n)
    solution = _substitute([right[i] for i in range(n)], factors, of_entry, order)
    return Elimination(
        ca.Function("factorise", [slopes, diagonal], [_column(values)], {"cse": True}),
        ca.Function("solve", [factors, right], [_column(solution)], {"cse": True}),
        len(values),
    )


def _pivot_order(n: int, entries: set[Entry]) -> list[int]:
    """Each next pivot is the diagonal entry whose elimination can fill in least."""
    left, pattern, order = set(range(n)), set(entries), []
    while left:
        rows = {k: [i for i in left if i != k and (i, k) in pattern] for k in left}
        columns = {k: [j for j in left if j != k and (k, j) in pattern] for k in left}
        pivot = min(left, key=lambda k: (len(rows[k]) * len(columns[k]), k))
        pattern |= {(i, j) for i in rows[pivot] for j in columns[pivot]}
        left.remove(pivot)
        order.append(pivot)
    return order


def _factorise(matrix: dict[Entry, Any], order: list[int]) -> dict[int, Any]:
    """Put the factors into the places of `matrix`, fill-in added; the inverses of the pivots."""
    inverses = {}
    for k, pivot in enumerate(order):
        below = [i for i in order[k + 1 :] if (i, pivot) in matrix]
        beside = [j for j in order[k + 1 :] if (pivot, j) in matrix]
        inverses[pivot] = 1 / matrix[pivot, pivot]
        for i in below:
            matrix[i, pivot] = matrix[i, pivot] * inverses[pivot]
            for j in beside:
                matrix[i, j] = matrix.get((i, j), 0) - matrix[i, pivot] * matrix[pivot, j]
    return inverses


def _substitute(
    b: list[Any], inverses: Any, factors: dict[Entry, Any], order: list[int]
) -> list[Any]:
    """Forward through the lower factor, back through the upper one."""
    for k, pivot in enumerate(order):
        for i in order[k + 1 :]:
            if (i, pivot) in factors:
                b[i] = b[i] - factors[i, pivot] * b[pivot]
    for k in reversed(range(len(order))):
        pivot = order[k]
        for j in order[k + 1 :]:
            if (pivot, j) in factors:
                b[pivot] = b[pivot] - factors[pivot, j] * b[j]
        b[pivot] = b[pivot] * inverses[pivot]
    return b


def _column(scalars: list[Any]) -> Any:
    return ca.densify(ca.vertcat(*scalars)) if scalars else ca.SX(0, 1)
