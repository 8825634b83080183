"""The generated elimination solves (d·I − J) z = b for any pattern, and fills in little."""

import casadi as ca
import numpy as np
import pytest

from fmus.packaging.plant.elimination import elimination


def patterns() -> dict[str, np.ndarray]:
    generator = np.random.default_rng(1)
    random = generator.random((9, 9)) < 0.3
    arrow = np.eye(12, dtype=bool)
    arrow[0, :] = arrow[:, 0] = True
    return {
        "no entries": np.zeros((3, 3), dtype=bool),
        "one state": np.ones((1, 1), dtype=bool),
        "dense": np.ones((6, 6), dtype=bool),
        "random": random,
        "arrow": arrow,
    }


def sparsity(pattern: np.ndarray) -> ca.Sparsity:
    return ca.sparsify(ca.DM(pattern.astype(float))).sparsity()


@pytest.mark.parametrize("name", patterns())
def test_solution_is_that_of_numpy(name: str) -> None:
    pattern = patterns()[name]
    n, generator = len(pattern), np.random.default_rng(2)
    jacobian = np.where(pattern, generator.normal(size=(n, n)), 0.0)
    solver = elimination(sparsity(pattern))
    nonzeros = jacobian.T[pattern.T]
    right, d = generator.normal(size=n), 7.0
    found = solver.solve(solver.factorise(nonzeros, d), right).full().ravel()
    assert np.allclose(found, np.linalg.solve(d * np.eye(n) - jacobian, right), rtol=1e-12)


def test_units_of_states_do_not_matter() -> None:
    """States scaled over twelve decades: each component keeps its relative accuracy."""
    generator, n = np.random.default_rng(3), 6
    jacobian, right = generator.normal(size=(n, n)), generator.normal(size=n)
    scale = np.geomspace(1e-6, 1e6, n)
    solver = elimination(ca.Sparsity.dense(n, n))
    scaled = scale[:, None] * jacobian / scale
    found = solver.solve(solver.factorise(scaled.T.ravel(), 7.0), scale * right).full().ravel()
    exact = np.linalg.solve(7.0 * np.eye(n) - jacobian, right)
    assert np.allclose(found / scale, exact, rtol=1e-12)


def test_an_arrow_is_eliminated_from_its_tip() -> None:
    """In the given order the first pivot would fill the matrix."""
    pattern = patterns()["arrow"]
    assert elimination(sparsity(pattern)).n_factors == pattern.sum()
