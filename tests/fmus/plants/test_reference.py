"""The committed reference trajectories are what the equations give."""

import numpy as np
import pytest

from tests.fmus.plants.reference import CASES, header, read, trajectory

# Time, inputs, states and outputs; a column is compared on the scale of its largest value.
TOLERANCE = 1e-8


@pytest.mark.parametrize(("plant", "inputs"), CASES, ids=lambda case: getattr(case, "name", ""))
def test_regenerated_to_eight_digits(plant, inputs):
    names, committed = read(plant)
    assert names == header(plant)
    again = trajectory(plant, inputs)
    assert again.shape == committed.shape
    scale = np.maximum(np.abs(committed).max(axis=0), 1e-12)
    assert (np.abs(again - committed) / scale).max() < TOLERANCE
