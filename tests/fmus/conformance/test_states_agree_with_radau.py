"""Each state stays within 1e-5 of its range of an independent integration."""

import numpy as np
from numpy.typing import NDArray

from tests.fmus.conformance.excitation import Excited

SHARE = 1e-5


def test_with_the_default_tolerance(excited: Excited, exact: NDArray[np.float64]) -> None:
    error = np.abs(excited.states - exact).max(axis=0)
    assert np.all(error <= SHARE * np.ptp(exact, axis=0))
    assert np.all(np.ptp(exact, axis=0) > 0), "every state must move, or nothing is compared"
