"""Rodas5P has order 5, its embedded solution order 4, by the order conditions; it is L-stable."""

import re
from collections.abc import Iterator
from itertools import combinations_with_replacement

import numpy as np
import pytest

from fmus.packaging.plant.codegen import RUNTIME
from fmus.packaging.plant.portable_parts import rodas5p

Tree = tuple["Tree", ...]
"""A rooted tree: the subtrees of its root."""

STAGES = len(rodas5p.A)


def lower(rows: tuple[tuple[float, ...], ...]) -> np.ndarray:
    return np.array([[*row, *[0.0] * (STAGES - len(row))] for row in rows])


# The solver's stages are U = Gamma k; k_i = h f(x + sum alpha_ij k_j) + h J sum gamma_ij k_j.
GAMMAS = np.linalg.inv(np.eye(STAGES) / rodas5p.GAMMA - lower(rodas5p.C))
ALPHA = lower(rodas5p.A) @ GAMMAS
BETA = ALPHA + GAMMAS
EMBEDDED = np.array([*rodas5p.A[-1], 0.0]) @ GAMMAS
WEIGHTS = np.array([*rodas5p.A[-1], 1.0]) @ GAMMAS


def order(tree: Tree) -> int:
    return 1 + sum(order(child) for child in tree)


def trees(n: int) -> Iterator[Tree]:
    """Every rooted tree with n vertices, once."""
    smaller = [tree for k in range(1, n) for tree in trees(k)]
    for count in range(n):
        for children in combinations_with_replacement(smaller, count):
            if sum(order(child) for child in children) == n - 1:
                yield children


def density(tree: Tree) -> int:
    return order(tree) * int(np.prod([density(child) for child in tree]))


def stage_weights(tree: Tree) -> np.ndarray:
    """Phi_i (Hairer & Wanner, IV.7): beta where a vertex has one branch, alpha where more."""
    coefficients = BETA if len(tree) == 1 else ALPHA
    return np.prod([np.ones(STAGES), *(coefficients @ stage_weights(t) for t in tree)], axis=0)


@pytest.mark.parametrize(("weights", "reached"), [(WEIGHTS, 5), (EMBEDDED, 4)], ids=["x", "x^"])
def test_order_conditions(weights: np.ndarray, reached: int) -> None:
    """All up to the order hold, and not all of the next."""
    assert [len(list(trees(n))) for n in range(1, 6)] == [1, 1, 2, 4, 9]
    residuals = [
        max(abs(weights @ stage_weights(tree) - 1 / density(tree)) for tree in trees(n))
        for n in range(1, reached + 2)
    ]
    assert max(residuals[:-1]) <= 2e-13
    assert residuals[-1] >= 1e-5


@pytest.mark.parametrize("weights", [WEIGHTS, EMBEDDED], ids=["x", "x^"])
def test_a_stable(weights: np.ndarray) -> None:
    """|R| <= 1 on the imaginary axis, and R vanishes at infinity for the solution."""

    def growth(z: complex) -> complex:
        matrix = np.eye(STAGES) - z * BETA
        return complex(1 + z * (weights @ np.linalg.solve(matrix, np.ones(STAGES))))

    assert max(abs(growth(1j * y)) for y in np.geomspace(1e-3, 1e6, 500)) <= 1 + 1e-12
    assert abs(growth(-1e12)) <= (1e-6 if weights is WEIGHTS else 1.0)


def test_the_native_solver_takes_the_same_coefficients() -> None:
    """Every coefficient of the Python solver stands in the C source, to the last digit."""
    text = (RUNTIME / "rodas5p.c").read_text()
    numbers = {float(number) for number in re.findall(r"-?\d+\.\d+", text)}
    for table in (rodas5p.A, rodas5p.C, ((rodas5p.GAMMA,),)):
        for row in table:
            assert set(row) <= numbers
