"""With zero Q the tuned controller is the fuzzy PID, bit for bit, whatever else is chosen."""

import itertools

import numpy as np
import pytest

from controllers.papers.ahn2009.fuzzy_pid import FuzzyPID
from controllers.papers.ahn2009.fuzzy_pid_step import N_FUZZY_OUTPUT
from controllers.papers.ahn2009.tuned_fuzzy_pid import TunedFuzzyPID
from tests.controllers.compiled import run

FIELDS = {
    "kp": (1e-4, 5e-4),
    "ki": (1e-4, 1e-3),
    "kd": (0.0, 1e-5),
    "error_range": 2000.0,
    "error_rate_range": 2e5,
    "u_min": -1.0,
    "u_max": 1.0,
    "derivative_filter": 0.02,
}
RNG = np.random.default_rng(2)
INPUTS = np.column_stack([np.full(80, 2000.0), RNG.normal(1500, 600, 80), RNG.normal(300, 99, 80)])
CHOICES = list(
    itertools.product(
        ("ekf", "robust_ekf"), ("reduced", "full"), ("paper", "causal"), ("quotient", "input")
    )
)


@pytest.mark.parametrize(("filter_name", "vector", "alignment", "sensitivity"), CHOICES)
def test_bit_equal(filter_name: str, vector: str, alignment: str, sensitivity: str) -> None:
    tuned = TunedFuzzyPID(
        filter=filter_name,
        vector=vector,
        alignment=alignment,
        sensitivity=sensitivity,
        sensitivity_bounds=(-500.0, 1000.0),
        q_centre=0,
        q_half_width=0,
        q_weight=0,
        **FIELDS,
    ).block(0.01)
    expected = run(FuzzyPID(**FIELDS).block(0.01), INPUTS[:, :2])
    got = run(tuned, INPUTS[:, : len(tuned.inputs)])[:, :N_FUZZY_OUTPUT]
    assert got.tobytes() == expected.tobytes()


def test_one_axis_can_be_tuned_alone() -> None:
    tuned = TunedFuzzyPID(
        sensitivity_bounds=(100.0, 1000.0),
        q_centre=(0, 1e-5, 0),
        q_half_width=(0, 1e-5, 0),
        q_weight=(0, 1e-4, 0),
        **FIELDS,
    ).block(0.01)
    last = run(tuned, INPUTS[:, :2])[-1]
    for axis in "pid":
        moved = [
            last[i] != signal.start
            for i, signal in enumerate(tuned.outputs)
            if signal.name.startswith(f"mf_{axis}_")
        ]
        assert len(moved) == 35
        assert any(moved) == (axis == "i")


def test_membership_functions_after_tuning_can_be_frozen_into_a_fuzzy_pid() -> None:
    block = TunedFuzzyPID(sensitivity_bounds=(100.0, 1000.0), **FIELDS).block(0.01)
    last = run(block, INPUTS[:, :2])[-1]
    at = [s.name for s in block.outputs].index("mf_p_a_1_1")
    names = ("theta_p", "theta_i", "theta_d")
    thetas = {name: tuple(last[at + 35 * a : at + 35 * (a + 1)]) for a, name in enumerate(names)}
    assert np.isfinite(run(FuzzyPID(**FIELDS, **thetas).block(0.01), INPUTS[:, :2])).all()
