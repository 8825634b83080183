"""A tolerance means what it says: each state stays within ten times it, as a share of its range.

Over six decades, under sines on every input and under a step forth and back, whose release leaves
the hydraulic plants swinging between a closed chamber and one at the reservoir's pressure.
"""

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from fmus.plant import Plant
from tests.fmus.conformance.excitation import Signal, excitation, excite, forth_and_back
from tests.fmus.conformance.radau import held_reference

MULTIPLE = 10.0
TOLERANCES = 10.0 ** -np.arange(3, 9)


@cache
def reference(plant: Plant, signal: Signal) -> NDArray[np.float64]:
    run = excite(plant, 3, signal=signal)
    return held_reference(plant, run.inputs, run.step)


def errors(plant: Plant, version: int, signal: Signal) -> NDArray[np.float64]:
    """Largest error of the worst state over its range, by tolerance."""
    exact = reference(plant, signal)
    span = np.where(np.ptp(exact, axis=0) > 0, np.ptp(exact, axis=0), 1.0)
    runs = [excite(plant, version, tolerance, signal).states for tolerance in TOLERANCES]
    return np.array([np.max(np.abs(states - exact) / span, initial=0.0) for states in runs])


@pytest.mark.parametrize("signal", [excitation, forth_and_back])
def test_within_a_factor_of_ten(plant: Plant, version: int, signal: Signal) -> None:
    found = errors(plant, version, signal)
    assert np.all(found <= MULTIPLE * TOLERANCES), found / TOLERANCES
    assert np.all(found[2:] <= np.maximum(found[:-2], 1e-11)), found
