"""Differences by name."""

import numpy as np
import pytest

from controllers.core.errors import ControllerError
from controllers.signals.difference import Difference
from tests.controllers.compiled import assert_bit_equal


def test_first_less_second() -> None:
    block = Difference(names=("a", "b"), units=("m", "Pa")).block(0.01)
    assert [s.name for s in block.inputs] == ["first_a", "first_b", "second_a", "second_b"]
    assert [s.unit for s in block.outputs] == ["m", "Pa"]
    given = np.random.default_rng(1).normal(size=(20, 4))
    assert np.array_equal(assert_bit_equal(block, given), given[:, :2] - given[:, 2:])


@pytest.mark.parametrize("given", [{"names": ()}, {"names": ("a", "a")}])
def test_names_must_differ(given: dict[str, tuple[str, ...]]) -> None:
    with pytest.raises(ControllerError, match="different names"):
        Difference(**given)


def test_units_must_fit() -> None:
    with pytest.raises(ControllerError, match="2 units"):
        Difference(names=("a", "b"), units=("m",))
