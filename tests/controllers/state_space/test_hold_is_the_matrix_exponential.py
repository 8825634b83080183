"""Sampling a linear model: against scipy's matrix exponential, and by composition."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from controllers.core.errors import ControllerError
from controllers.papers.serkies2013.two_mass import drive_model
from controllers.state_space.discretisation import held


def exact(A, B, T):
    n, m = B.shape
    whole = expm(np.block([[A, B], [np.zeros((m, n + m))]]) * T)
    return whole[:n, :n], whole[:n, n:]


def assert_close(found, expected, tolerance):
    for one, other in zip(found, expected, strict=True):
        assert np.abs(one - other).max() <= tolerance * max(np.abs(other).max(), 1.0)


@settings(max_examples=200, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 10_000),
    n=st.integers(1, 6),
    m=st.integers(1, 3),
    size=st.floats(1e-4, 3.0),
)
def test_any_model_sampled_up_to_three_of_its_time_constants(seed, n, m, size):
    """‖A‖·T is `size`: beyond, the condition of the exponential is what is measured."""
    rng = np.random.default_rng(seed)
    A, B = rng.normal(size=(n, n)), rng.normal(size=(n, m))
    T = size / np.abs(A).sum(axis=1).max()
    assert_close(held(A, B, T), exact(A, B, T), 2e-13)


@pytest.mark.parametrize("T_2", [0.05, 0.203, 0.6])
@pytest.mark.parametrize("T", [5e-4, 0.01, 0.3])
def test_the_drive(T_2, T):
    A, B = drive_model(0.203, T_2, 1.2e-3)
    assert_close(held(A, B, T), exact(A, B, T), 1e-11)


def test_stiff_decay_underflows_to_its_limit():
    Phi, Gamma = held(np.array([[-1e6]]), np.array([[1e6]]), 1.0)
    assert Phi[0, 0] == 0.0
    assert Gamma[0, 0] == pytest.approx(1.0, rel=1e-9)


@settings(max_examples=50, deadline=None, derandomize=True)
@given(seed=st.integers(0, 10_000), T=st.floats(1e-3, 0.5))
def test_two_samples_are_one_of_twice_the_length(seed, T):
    rng = np.random.default_rng(seed)
    A, B = rng.normal(size=(4, 4)), rng.normal(size=(4, 2))
    Phi, Gamma = held(A, B, T)
    assert_close((Phi @ Phi, Phi @ Gamma + Gamma), held(A, B, 2 * T), 1e-13)


def test_faults():
    with pytest.raises(ControllerError, match="shape"):
        held(np.eye(2), np.ones((3, 1)), 0.1)
    with pytest.raises(ControllerError, match="sample_time"):
        held(np.eye(2), np.ones((2, 1)), 0.0)
