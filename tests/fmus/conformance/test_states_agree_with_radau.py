"""Each state stays within 1e-5 of its range of an independent integration."""

import numpy as np
from numpy.typing import NDArray

from tests.fmus.conformance.excitation import Excited, excite

SHARE = 1e-5


def test_with_the_default_tolerance(excited: Excited, exact: NDArray[np.float64]) -> None:
    error = np.abs(excited.states - exact).max(axis=0)
    assert np.all(error <= SHARE * np.ptp(exact, axis=0))
    assert np.all(np.ptp(exact, axis=0) > 0), "every state must move, or nothing is compared"


def test_error_falls_with_the_tolerance(
    excited: Excited, exact: NDArray[np.float64], version: int
) -> None:
    """From 1e-3 to 1e-9, each factor of a hundred gains at least ten."""
    span = np.ptp(exact, axis=0)
    tolerances = (1e-3, 1e-5, 1e-7, 1e-9)
    runs = [excite(excited.plant, version, tolerance).states for tolerance in tolerances]
    errors = np.array([np.max(np.abs(states - exact) / span) for states in runs])
    assert np.all(errors[:-1] / errors[1:] >= 10.0), dict(zip(tolerances, errors, strict=True))
