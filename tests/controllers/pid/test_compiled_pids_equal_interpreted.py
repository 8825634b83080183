"""The compiled step functions of the PIDs give the interpreted ones' bits."""

import numpy as np
import pytest

from controllers.papers.ahn2009.fuzzy_pid import FuzzyPID
from controllers.pid.pid import PID
from tests.controllers.compiled import assert_bit_equal

T = 0.01
INPUTS = np.column_stack(
    [
        np.repeat([0.0, 2000.0, 500.0], 700),
        np.random.default_rng(7).normal(1000.0, 800.0, 2100),
    ]
)
LAW = {"u_min": -1.0, "u_max": 1.0, "derivative_filter": 0.02}


@pytest.mark.parametrize("anti_windup", ["none", "conditional", "back_calculation"])
def test_pid(anti_windup: str) -> None:
    controller = PID(kp=5e-4, ki=1e-3, kd=1e-5, anti_windup=anti_windup, **LAW)
    rows = assert_bit_equal(controller.block(T), INPUTS)
    assert set(rows[:, 5]) == {-1.0, 0.0, 1.0}


@pytest.mark.parametrize(("implication", "aggregation"), [("min", "sum"), ("product", "max")])
def test_fuzzy_pid(implication: str, aggregation: str) -> None:
    controller = FuzzyPID(
        kp=(1e-4, 5e-4),
        ki=(0.0, 1e-3),
        kd=(0.0, 1e-5),
        error_range=2000.0,
        error_rate_range=40000.0,
        implication=implication,
        aggregation=aggregation,
        rule_firing=True,
        **LAW,
    )
    rows = assert_bit_equal(controller.block(T), INPUTS)
    assert len(np.unique(rows[:, 9])) > 100
