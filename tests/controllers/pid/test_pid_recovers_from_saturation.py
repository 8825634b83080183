"""Anti-windup: how long the output stays at its limit after the error has changed sign."""

import numpy as np
import pytest

from controllers.pid.pid import PID
from tests.controllers.compiled import run

T = 0.01


def leaving_time(anti_windup: str) -> int:
    """Samples at the limit after e has gone from +1 to −1, having been +1 for 5 s."""
    error = np.where(np.arange(2000) < 500, 1.0, -1.0)
    controller = PID(kp=0.2, ki=1.0, u_max=0.5, u_min=-0.5, anti_windup=anti_windup)
    rows = run(controller.block(T), np.column_stack([error, np.zeros_like(error)]))
    return int(np.argmax(rows[500:, 0] < 0.5))


def test_without_anti_windup_the_integral_must_unwind() -> None:
    # ∫e = 4.99 s at the change; u = −0.2 + I < 0.5 needs I < 0.7, which takes 429 to 430 samples.
    assert leaving_time("none") in (429, 430)


@pytest.mark.parametrize("anti_windup", ["conditional", "back_calculation"])
def test_with_anti_windup_the_output_leaves_at_once(anti_windup: str) -> None:
    assert leaving_time(anti_windup) == 0


def test_back_calculation_settles_where_its_equation_says() -> None:
    # dI/dt = e + (u − u_w)/(K_i·T_t) = 0 with constant e: u_w = u_max + K_i·T_t·e.
    controller = PID(
        kp=0.2, ki=2.0, u_max=0.5, u_min=-0.5, anti_windup="back_calculation", tracking_time=0.05
    )
    rows = run(controller.block(T), np.tile([1.0, 0.0], (2000, 1)))
    assert rows[-1, 1] + rows[-1, 2] == pytest.approx(0.5 + 2.0 * 0.05 * 1.0, rel=1e-9)


def test_conditional_integration_still_integrates_towards_the_range() -> None:
    inputs = np.concatenate([np.tile([1.0, 0.0], (100, 1)), np.tile([-0.1, 0.0], (100, 1))])
    controller = PID(kp=0.0, ki=1.0, bias=0.6, u_max=0.5, u_min=-0.5)
    rows = run(controller.block(T), inputs)
    np.testing.assert_array_equal(rows[:100, 2], 0.0)
    assert rows[-1, 2] < -0.08
