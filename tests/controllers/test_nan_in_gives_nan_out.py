"""A step function cannot raise: an input that is no number shows as NaN in u, from then on."""

import numpy as np
import pytest

from controllers.core.block import Block
from controllers.papers.ahn2009.fuzzy_pid import FuzzyPID
from controllers.papers.ahn2009.tuned_fuzzy_pid import TunedFuzzyPID
from controllers.pid.pid import PID
from tests.controllers.compiled import assert_bit_equal

FUZZY = {
    "kp": (1e-4, 5e-4),
    "ki": (1e-4, 1e-3),
    "kd": (0.0, 1e-5),
    "error_range": 2000.0,
    "error_rate_range": 2e5,
}
BLOCKS = {
    "pid": PID(kp=1.0, ki=1.0, kd=0.1, u_max=5.0).block(0.01),
    "fuzzy_pid": FuzzyPID(**FUZZY).block(0.01),
    "reduced": TunedFuzzyPID(**FUZZY, sensitivity_bounds=(1.0, 900.0)).block(0.01),
    "full": TunedFuzzyPID(**FUZZY, sensitivity_bounds=(1.0, 900.0), vector="full").block(0.01),
}


@pytest.mark.parametrize("block", BLOCKS.values(), ids=BLOCKS)
def test_measured_without_a_value(block: Block) -> None:
    inputs = np.tile([1000.0, 900.0], (6, 1))
    inputs[3, 1] = np.nan
    u = assert_bit_equal(block, inputs)[:, 0]
    assert np.isfinite(u[:3]).all()
    assert np.isnan(u[3:]).all()
