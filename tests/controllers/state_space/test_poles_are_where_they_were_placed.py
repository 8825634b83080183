"""Pole placement: (5)–(8) of Serkies & Szabat 2013 as corrected, and Ackermann's formula."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from controllers.core.errors import ControllerError
from controllers.papers.serkies2013.two_mass import (
    drive_model,
    two_mass_design,
    two_mass_gains_as_printed,
)
from controllers.state_space.pole_placement import (
    characteristic_polynomial,
    design_of,
    place,
    with_integral,
)

T_1, T_C = 0.203, 1.2e-3
INERTIA = st.floats(0.02, 2.0)
FREQUENCY = st.floats(5.0, 200.0)
DAMPING = st.floats(0.1, 2.0)


def loop(T_2):
    A, B = drive_model(T_1, T_2, T_C)
    return with_integral(A[:3, :3], B[:3, 0], np.array([0.0, 1.0, 0.0]))


@settings(max_examples=200, deadline=None, derandomize=True)
@given(T_2=INERTIA, omega=FREQUENCY, xi=DAMPING)
def test_the_characteristic_polynomial_is_the_designed_one(T_2, omega, xi):
    design = two_mass_design(T_1, T_2, T_C, omega, xi)
    square = np.polymul([1, 2 * xi * omega, omega**2], [1, 2 * xi * omega, omega**2])
    assert design.wanted_polynomial == pytest.approx(square, rel=1e-12)
    # What rounding may do to the coefficients: the free resonance cancels in them.
    resonance = np.sqrt((1 / T_1 + 1 / T_2) / T_C)
    assert design.residual < 1e-13 * (1 + (resonance / omega) ** 4)


@pytest.mark.parametrize("T_2", [0.1, 0.203, 0.406])
@pytest.mark.parametrize("xi", [0.5, 0.7])
def test_poles_to_1e_6(T_2, xi):
    """A double pole moves by the root of what moves its polynomial: 1e-6 of 40 rad/s."""
    design = two_mass_design(T_1, T_2, T_C, 40.0, xi)
    pair = 40.0 * complex(-xi, np.sqrt(1 - xi**2))
    for pole in design.poles:
        assert min(abs(pole - pair), abs(pole - pair.conjugate())) < 1e-6 * 40.0


@settings(max_examples=50, deadline=None, derandomize=True)
@given(T_2=st.floats(0.05, 1.0), omega=st.floats(20.0, 100.0), xi=DAMPING)
def test_ackermann_finds_the_same_gains(T_2, omega, xi):
    closed_form = two_mass_design(T_1, T_2, T_C, omega, xi)
    found = place(*loop(T_2), closed_form.wanted)
    scale = np.abs(closed_form.K).max()
    assert np.abs(found.K - closed_form.K).max() < 1e-9 * scale


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("T_2", [0.1, 0.203, 0.406])
def test_as_printed_the_loop_is_unstable_with_either_sign(T_2, sign):
    k = np.empty(4)
    two_mass_gains_as_printed(np.array([T_1, T_C, 40.0, 0.7]), np.array([T_2]), k)
    design = design_of(*loop(T_2), np.array([-k[0], *(sign * k[[1, 3, 2]])]), [-1.0] * 4)
    assert design.poles.real.max() > 1.0


@settings(max_examples=100, deadline=None, derandomize=True)
@given(seed=st.integers(0, 10_000), n=st.integers(1, 5))
def test_the_gains_of_any_controllable_model_are_found_from_its_poles(seed, n):
    rng = np.random.default_rng(seed)
    A, b, K = rng.normal(size=(n, n)), rng.normal(size=n), rng.normal(size=n)
    C = np.column_stack([np.linalg.matrix_power(A, k) @ b for k in range(n)])
    assume(np.linalg.cond(C) < 1e3)
    design = place(A, b, list(np.linalg.eigvals(A - np.outer(b, K))))
    assert np.abs(design.K - K).max() < 1e-9
    assert design.residual < 1e-10


def test_the_characteristic_polynomial_of_a_companion_matrix_is_read_off():
    companion = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-6.0, -11.0, -5.0]])
    assert characteristic_polynomial(companion) == pytest.approx([1.0, 5.0, 11.0, 6.0], rel=1e-14)


def test_faults():
    A, b = np.diag([-1.0, -1.0]), np.array([1.0, 1.0])
    with pytest.raises(ControllerError, match="controllable"):
        place(A, b, [-2.0, -3.0])
    with pytest.raises(ControllerError, match="conjugate"):
        place(np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([0.0, 1.0]), [-1 + 1j, -2.0])
    with pytest.raises(ControllerError, match="2 poles"):
        place(A, b, [-2.0])
