"""The automatic choosing functions: a partition of unity over any tiling, and (3) as printed."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.core.errors import ControllerError
from controllers.papers.takata.choosing import ChoosingFunctions

INF = math.inf


def split(box, rng, depth):
    """A random tiling of `box` by repeated halving, whose cuts do not line up."""
    lower, upper = box
    if depth == 0:
        return [box]
    j = int(rng.integers(len(lower)))
    low, high = max(lower[j], -4.0), min(upper[j], 4.0)
    cut = float(rng.uniform(low, high))
    first = (lower, (*upper[:j], cut, *upper[j + 1 :]))
    second = ((*lower[:j], cut, *lower[j + 1 :]), upper)
    return [*split(first, rng, depth - 1), *split(second, rng, int(rng.integers(depth)))]


@given(
    seed=st.integers(0, 2**32 - 1),
    variables=st.integers(1, 3),
    depth=st.integers(0, 4),
    sharpness=st.floats(0.05, 50.0),
    scale=st.sampled_from([1.0, 10.0, 1e6]),
)
def test_weights_sum_to_one_everywhere(seed, variables, depth, sharpness, scale):
    rng = np.random.default_rng(seed)
    boxes = split(((-INF,) * variables, (INF,) * variables), rng, depth)
    functions = ChoosingFunctions(*zip(*boxes, strict=True), sharpness)
    for c in rng.uniform(-scale, scale, size=(10, variables)):
        weights = functions.weights(c)
        assert abs(weights.sum() - 1.0) < 1e-14
        assert weights.min() >= 0.0


def test_each_weight_is_equation_3():
    functions = ChoosingFunctions(((-INF, 0.0), (-INF, -INF), (1.0, -INF)),
                                  ((1.0, INF), (1.0, 0.0), (INF, INF)), 3.0)  # fmt: skip
    for c in np.random.default_rng(1).uniform(-2, 2, (50, 2)):
        for i, weight in enumerate(functions.weights(c)):
            product = 1.0
            for v, a, b in zip(c, functions.lower[i], functions.upper[i], strict=True):
                product *= 1 - 1 / (1 + np.exp(6.0 * (v - a))) - 1 / (1 + np.exp(-6.0 * (v - b)))
            assert weight == pytest.approx(product, abs=1e-15)


def test_about_one_inside_a_half_on_a_side_and_zero_outside():
    functions = ChoosingFunctions(((-INF,), (0.6,)), ((0.6,), (INF,)), 8.0)
    assert functions.weights([0.6]) == pytest.approx([0.5, 0.5], abs=1e-15)
    assert functions.weights([-0.4])[0] > 1 - 1e-6
    assert functions.weights([1.6])[0] < 1e-6
    assert functions.weights([-1e9]).tolist() == [1.0, 0.0]


@pytest.mark.parametrize(
    ("lower", "upper"),
    [
        (((-INF,), (0.7,)), ((0.6,), (INF,))),  # a gap
        (((-INF,), (0.5,)), ((0.6,), (INF,))),  # an overlap
        (((-3.0,),), ((3.0,),)),  # ends
        (((-INF, -INF), (0.0, 0.0)), ((0.0, INF), (INF, INF))),  # a quarter is missing
    ],
)
def test_sections_that_do_not_tile_the_space_are_refused(lower, upper):
    with pytest.raises(ControllerError, match="tile"):
        ChoosingFunctions(lower, upper, 8.0)
