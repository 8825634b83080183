"""Compiled and interpreted tuner, bit for bit, over outputs, parameters θ, covariances and all."""

import numpy as np
import pytest

from controllers.papers.ahn2009.tuned_fuzzy_pid import TunedFuzzyPID
from tests.controllers.compiled import assert_bit_equal

N = 350
RNG = np.random.default_rng(8)
INPUTS = np.column_stack(
    [
        np.repeat([0.0, 2000.0], N // 2),
        np.cumsum(RNG.normal(0, 60, N)) + 900 + 40 * RNG.standard_t(1.5, N),
        RNG.normal(400, 300, N),
    ]
)


@pytest.mark.parametrize(
    ("filter_name", "vector", "alignment", "sensitivity"),
    [
        ("ekf", "reduced", "paper", "quotient"),
        ("robust_ekf", "reduced", "causal", "input"),
        ("ekf", "full", "causal", "input"),
        ("robust_ekf", "full", "paper", "quotient"),
    ],
)
def test_bit_equal(filter_name: str, vector: str, alignment: str, sensitivity: str) -> None:
    block = TunedFuzzyPID(
        kp=(1e-4, 5e-4),
        ki=(0.0, 1e-3),
        kd=(0.0, 1e-5),
        error_range=2000.0,
        error_rate_range=2e5,
        u_min=-1.0,
        u_max=1.0,
        derivative_filter=0.02,
        filter=filter_name,
        vector=vector,
        alignment=alignment,
        sensitivity=sensitivity,
        sensitivity_bounds=(50.0, 1000.0),
        r=100.0,
        q_weight=1e-3,
        rule_firing=True,
    ).block(0.01)
    rows = assert_bit_equal(block, INPUTS[:, : len(block.inputs)])
    names = [signal.name for signal in block.outputs]
    moved = rows[-1, names.index("mf_p_a_1_1") :] != rows[0, names.index("mf_p_a_1_1") :]
    assert moved[:105].sum() > 20
