"""Each state stays within 1e-5 of its range of an independent integration."""

import numpy as np
from numpy.typing import NDArray

from tests.fmus.conformance.excitation import Excited, excite

SHARE = 1e-5
MULTIPLE = 50.0


def test_with_the_default_tolerance(excited: Excited, exact: NDArray[np.float64]) -> None:
    error = np.abs(excited.states - exact).max(axis=0)
    assert np.all(error <= SHARE * np.ptp(exact, axis=0))
    assert np.all(np.ptp(exact, axis=0) > 0), "every state must move, or nothing is compared"


def test_error_follows_the_tolerance_over_six_decades(
    excited: Excited, exact: NDArray[np.float64], version: int
) -> None:
    """It falls each time, and stays below a fixed multiple of what was asked for."""
    span = np.ptp(exact, axis=0)
    tolerances = np.array([1e-3, 1e-5, 1e-7, 1e-9])
    runs = [excite(excited.plant, version, tolerance).states for tolerance in tolerances]
    errors = np.array([np.max(np.abs(states - exact) / span, initial=0.0) for states in runs])
    assert np.all(errors <= MULTIPLE * tolerances), errors
    assert np.all(np.diff(errors) <= 0.0), errors
