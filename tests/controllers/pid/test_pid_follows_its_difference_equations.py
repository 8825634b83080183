"""PID parts against closed forms: ramps and steps, every integration rule, both derivatives."""

import math

import numpy as np
import pytest

from controllers.core.errors import ControllerError
from controllers.pid.pid import PID
from tests.controllers.compiled import run

T = 0.01
K = np.arange(200)


def parts(controller: PID, error: np.ndarray) -> np.ndarray:
    rows = run(controller.block(T), np.column_stack([error, np.zeros_like(error)]))
    return rows[:, :5]


@pytest.mark.parametrize(
    ("rule", "sum_of_ramp"),
    [
        ("forward", (K - 1) * K / 2),
        ("backward", K * (K + 1) / 2),
        ("trapezoidal", K**2 / 2),
    ],
)
def test_integral_of_a_ramp(rule: str, sum_of_ramp: np.ndarray) -> None:
    # e = 3·t: the three rules give three different sums, the trapezoid the exact integral.
    out = parts(PID(kp=0.0, ki=2.0, integration=rule), 3.0 * T * K)
    np.testing.assert_allclose(out[:, 2], 2.0 * 3.0 * T * T * sum_of_ramp, rtol=1e-12)


def test_integral_of_a_constant_is_time() -> None:
    for rule in ("forward", "backward", "trapezoidal"):
        out = parts(PID(kp=0.0, ki=1.0, integration=rule), np.ones(200))
        np.testing.assert_allclose(out[:, 2], T * K, rtol=1e-12)


@pytest.mark.parametrize("filter_time", [0.003, 0.05, 1.0])
def test_filtered_derivative_of_a_ramp_is_exact(filter_time: float) -> None:
    # s/(T_f·s + 1) answers a ramp of slope c by c·(1 − exp(−t/T_f)), at every sample time.
    out = parts(PID(kp=0.0, kd=1.0, derivative_filter=filter_time), 3.0 * T * K)
    np.testing.assert_allclose(out[:, 3], 3.0 * (1 - np.exp(-K * T / filter_time)), atol=1e-12)


def test_derivative_without_filter_is_the_difference_quotient() -> None:
    out = parts(PID(kp=0.0, kd=0.5), np.sin(K))
    np.testing.assert_allclose(out[1:, 3], 0.5 * np.diff(np.sin(K)) / T, rtol=1e-12)
    assert out[0, 3] == 0.0


def test_derivative_on_measurement_ignores_the_reference() -> None:
    reference = np.where(K < 50, 0.0, 100.0)
    inputs = np.column_stack([reference, np.sin(K * T)])
    on_error = run(PID(kp=0.0, kd=1.0).block(T), inputs)[:, 3]
    on_measurement = run(PID(kp=0.0, kd=1.0, derivative_on="measurement").block(T), inputs)[:, 3]
    jump = np.zeros(200)
    jump[50] = 100.0 / T
    np.testing.assert_allclose(on_error - on_measurement, jump, atol=1e-9)


def test_first_sample_has_neither_integral_nor_derivative() -> None:
    out = parts(PID(kp=1.0, ki=5.0, kd=5.0), np.full(1, 7.0))
    np.testing.assert_array_equal(out[0], [7.0, 7.0, 0.0, 0.0, 7.0])


def test_bias_is_added_and_limits_hold() -> None:
    inputs = np.column_stack([100 * np.sin(K), np.zeros(200)])
    rows = run(PID(kp=1.0, bias=0.25, u_min=-2.0, u_max=3.0).block(T), inputs)
    np.testing.assert_array_equal(rows[:, 0], np.clip(0.25 + inputs[:, 0], -2.0, 3.0))
    np.testing.assert_array_equal(rows[:, 5], np.sign(0.25 + inputs[:, 0] - rows[:, 0]))


@pytest.mark.parametrize(
    "fault",
    [{"kp": math.nan}, {"kp": 1.0, "u_min": 1.0, "u_max": 1.0}, {"kp": 1.0, "integration": "x"}],
)
def test_faults_are_named(fault: dict) -> None:
    with pytest.raises(ControllerError, match=r"PID\.(kp|u_min|integration)"):
        PID(**fault)
