"""Two halves of an oscillator against the whole one: errors fall with the order of the wires.

Held inputs make an error of first order in the communication step, linear ones of second order,
with each algorithm (`benchmarks.coupling_order` states the theory).
"""

import numpy as np
import pytest

from benchmarks.coupling_order import ALGORITHMS, STATES, coupled, monolithic, study

STEPS = (0.01, 0.005, 0.0025)


@pytest.mark.parametrize("extrapolation", [0, 1])
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_order_is_one_with_hold_and_two_with_linear_wires(
    algorithm: str, extrapolation: int
) -> None:
    found = study(algorithm, extrapolation, STEPS, stop_time=0.5)
    assert found.order == pytest.approx(1 + extrapolation, abs=0.15)


def test_the_reference_is_the_oscillator() -> None:
    """A fine step comes close, so that it is no other system that the errors are measured to."""
    result = coupled("iterative", 1, 0.0005, 0.5).run()
    found = np.column_stack([result[name] for name in STATES])
    exact = monolithic(result.time)
    assert np.abs(found - exact).max() < 1e-5 * np.abs(exact).max()
