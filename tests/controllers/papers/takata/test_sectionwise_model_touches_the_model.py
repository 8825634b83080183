"""Sectionwise linear models touch f where they were made, and are united by the weights."""

import math
from itertools import pairwise

import numpy as np

from controllers.papers.takata.sectionwise_model import SectionwiseModel
from tests.controllers.compiled import assert_bit_equal, run

INF = math.inf
MODEL = SectionwiseModel(
    model="controllers.papers.takata.machine_model:MachineParameters",
    points=((0.0, 0.0), (1.51, 0.0)),
    lower=((-INF,), (0.6,)), upper=((0.6,), (INF,)), sharpness=8.0, separative=((1.0, 0.0),),
    Q=(1.0, 1.0, 1.0), R=(1.0,), sigma=0.1,
)  # fmt: skip
NAMES = [s.name for s in MODEL.outputs()]


def at(states):
    rows = run(MODEL.block(0.01), np.atleast_2d(states))
    return {name: rows[:, i] for i, name in enumerate(NAMES)}


def test_the_error_is_of_second_order_about_each_point():
    for i, point in enumerate(MODEL.points):
        errors = []
        for h in (1e-2, 5e-3, 2.5e-3):
            y = at(np.add(point, h))
            errors.append(abs(y[f"section_{i}_speed"][0] - y["rate_speed"][0]))
        assert all(3.8 < a / b < 4.2 for a, b in pairwise(errors))
        assert abs(at(point)[f"section_{i}_speed"] - at(point)["rate_speed"])[0] < 1e-13


def test_united_by_the_choosing_functions():
    states = np.random.default_rng(2).uniform((-3, -5), (3, 5), (200, 2))
    y = at(states)
    weights = np.array([MODEL.functions().weights(x[:1]) for x in states])
    for name in ("angle_deviation", "speed"):
        united = sum(weights[:, i] * y[f"section_{i}_{name}"] for i in range(2))
        assert np.abs(y[f"united_{name}"] - united).max() < 1e-11


def test_compiled_equals_interpreted():
    assert_bit_equal(MODEL.block(0.01), np.random.default_rng(3).uniform(-3, 3, (100, 2)))
