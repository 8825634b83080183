"""The lead loop, plant and controller as FMUs, under other masters.

A master that steps the controller first and passes its output on for the same step closes the loop
as ours does. Ecos and libcosim step all FMUs at once and pass the outputs on afterwards, so what
the controller computes from y(t_k) acts from t_k+1 on. That is our loop with a delay of one sample
on the wire from the controller to the plant, and it is to the last bit.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.peers.loops import CONTROLLERS, STEP, TARGET, order, ours
from tests.peers.order import run_in
from tests.peers.tools import skip_without


@pytest.mark.parametrize("name", CONTROLLERS)
@pytest.mark.parametrize(
    ("tool", "version", "portable"),
    [
        ("ecos", 2, False),
        ("ecos", 3, False),
        ("ecos", 2, True),
        ("libcosim", 2, False),
        ("libcosim", 2, True),
    ],
)
def test_one_sample_of_delay_and_not_a_bit_more(
    tool: str, version: int, portable: bool, name: str
) -> None:
    skip_without(tool)
    expected = ours(name, version, STEP)
    assert np.ptp(expected[:, 0]) > TARGET / 2
    assert np.array_equal(run_in(tool, order(name, version, portable=portable)), expected)


@pytest.mark.parametrize("tool", ["ecos", "libcosim"])
def test_half_a_sample_where_they_communicate_twice_a_sample(tool: str) -> None:
    skip_without(tool)
    asked = order("pid", 2, portable=False)
    asked = replace(asked, step=asked.step / 2, steps=2 * asked.steps)
    found = run_in(tool, asked)[1::2]
    assert np.array_equal(found, ours("pid", 2, STEP / 2))


@pytest.mark.parametrize("portable", [False, True], ids=["native", "portable"])
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", CONTROLLERS)
def test_no_delay_where_the_controller_steps_first(name: str, version: int, portable: bool) -> None:
    asked = order(name, version, portable=portable, controller_first=True)
    assert np.array_equal(run_in("fmpy", asked), ours(name, version, 0.0))
