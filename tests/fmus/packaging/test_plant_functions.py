"""Numeric f, h and Jacobians of a plant: values, exact derivatives, equilibria."""

import numpy as np
import pytest

from fmus.packaging.errors import PackagingError
from fmus.packaging.plant.functions import plant_functions
from tests.fmus.packaging.plants import finite_escape, hydraulic, oscillator, static_gain


def test_the_oscillator_linearises_to_its_textbook_matrices() -> None:
    """A, B, C, D of m x'' + d x' + k x = F with outputs x, k x, x''."""
    m, d, k = 2.0, 1.5, 80.0
    linear = plant_functions(oscillator).linearise([0.3, -0.2], [5.0])
    assert np.allclose(linear.A, [[0, 1], [-k / m, -d / m]], rtol=1e-15, atol=0)
    assert np.allclose(linear.B, [[0], [1 / m]], rtol=1e-15, atol=0)
    assert np.allclose(linear.C, [[1, 0], [k, 0], [-k / m, -d / m]], rtol=1e-15, atol=0)
    assert np.allclose(linear.D, [[0], [0], [1 / m]], rtol=1e-15, atol=0)


def test_jacobians_agree_with_central_differences() -> None:
    functions = plant_functions(hydraulic)
    nominal = np.array([state.nominal for state in hydraulic.states])
    x, u = functions.x_start + 0.1 * nominal, np.array([50.0])
    f_x, _, h_x, _ = functions.jacobians(x, u)
    for j, scale in enumerate(nominal):
        dx = np.zeros(5)
        dx[j] = 1e-4 * scale
        for exact, function in ((f_x, functions.f), (h_x, functions.h)):
            difference = (function(x + dx, u) - function(x - dx, u)) / (2 * dx[j])
            size = np.abs(function(x, u)) / scale + np.abs(difference)
            assert np.all(np.abs(exact[:, j] - difference) <= 1e-6 * size + 1e-300)


def test_a_trimmed_plant_stands_still() -> None:
    functions = plant_functions(hydraulic)
    x = functions.trim([5.0])
    nominal = np.array([state.nominal for state in hydraulic.states])
    assert np.abs(functions.f(x, [5.0]) / nominal).max() <= 1e-9


def test_no_equilibrium_is_an_error_that_names_the_state() -> None:
    """x' = x^2 + 0 has one at 0; a pump at speed without leakage has none."""
    functions = plant_functions(hydraulic)
    p = functions.p_start.copy()
    p[[q.name for q in hydraulic.parameters].index("leakage")] = 0.0
    with pytest.raises(PackagingError, match="no equilibrium"):
        functions.trim([5.0], p)
    assert plant_functions(finite_escape).trim([]) == pytest.approx([0.0], abs=1e-4)


def test_parameters_override_the_defaults() -> None:
    functions = plant_functions(static_gain)
    assert functions.h([], [2.0, 3.0]) == pytest.approx([9.0, 5.0])
    assert functions.h([], [2.0, 3.0], [2.0]) == pytest.approx([12.0, 5.0])


def test_a_wrong_shape_names_both_shapes() -> None:
    with pytest.raises(PackagingError, match=r"states have shape \(3,\), expected \(2,\)"):
        plant_functions(oscillator).f([1.0, 2.0, 3.0], [0.0])
