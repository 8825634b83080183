"""∂y/∂u: the guarded quotient (40), the input, and which instants are put together."""

import numpy as np
import pytest

from controllers.papers.ahn2009.tuned_fuzzy_pid import TunedFuzzyPID
from controllers.papers.ahn2009.tuned_step import Y_SENSITIVITY
from controllers.papers.ahn2009.tuner import quotient
from tests.controllers.compiled import run

FIELDS = {
    "kp": (1e-4, 5e-4),
    "ki": (1e-4, 1e-3),
    "kd": (0.0, 1e-6),
    "error_range": 2000.0,
    "error_rate_range": 2e5,
}


def closed_loop(gain: float, **fields: object) -> np.ndarray:
    """Rows (y_k, outputs) with the plant y_{k+1} = gain·u_k and a reference that moves."""
    block = TunedFuzzyPID(**FIELDS, **fields).block(0.01)
    p, x, out = block.parameters.copy(), block.state.copy(), np.zeros(len(block.outputs))
    rows, y = [], 0.0
    for k in range(60):
        block.step(p, x, np.array([1000.0 + 500.0 * np.sin(k), y]), out)
        rows.append([y, *out])
        y = gain * out[0]
    return np.array(rows)


@pytest.mark.parametrize("gain", [300.0, -250.0])
def test_causal_quotient_of_a_static_plant_is_its_gain(gain: float) -> None:
    rows = closed_loop(gain, sensitivity_bounds=(-1e3, 1e3), smallest_du=0.0, alignment="causal")
    np.testing.assert_allclose(rows[2:, 1 + Y_SENSITIVITY], gain, rtol=1e-9)
    assert rows[1, 1 + Y_SENSITIVITY] == 0.0  # one Δu is not yet known


def test_paper_quotient_divides_by_the_step_of_u_just_made() -> None:
    rows = closed_loop(300.0, sensitivity_bounds=(-1e6, 1e6), smallest_du=0.0, alignment="paper")
    expected = np.diff(rows[:, 0]) / np.diff(rows[:, 1])
    np.testing.assert_allclose(rows[1:, 1 + Y_SENSITIVITY], expected, rtol=1e-9)


def test_quotient_is_kept_for_small_steps_and_between_bounds() -> None:
    assert quotient(7.0, 5.0, 0.0, 0.0, -9.0, 9.0) == 7.0
    assert quotient(7.0, 5.0, 0.9e-3, 1e-3, -9.0, 9.0) == 7.0
    assert quotient(7.0, 5.0, -1.0, 1e-3, 1.0, 9.0) == 1.0
    assert quotient(7.0, 50.0, 1.0, 1e-3, 1.0, 9.0) == 9.0
    assert quotient(7.0, 6.0, 2.0, 1e-3, 1.0, 9.0) == 3.0


@pytest.mark.parametrize(("bounds", "start"), [((50, 900), 50), ((-900, -50), -50), ((-1, 2), 0)])
def test_start_is_the_bound_nearest_zero(bounds: tuple[float, float], start: float) -> None:
    block = TunedFuzzyPID(**FIELDS, sensitivity_bounds=bounds).block(0.01)
    assert run(block, np.zeros((1, 2)))[0, Y_SENSITIVITY] == start


def test_input_is_used_with_its_own_instant() -> None:
    given = np.array([100.0, 200.0, 300.0, 9e9])
    inputs = np.column_stack([np.full(4, 1500.0), np.linspace(0, 100, 4), given])
    for alignment, expected in (
        ("paper", [100, 200, 300, 800]),
        ("causal", [50, 100, 200, 300]),
    ):
        block = TunedFuzzyPID(
            **FIELDS, sensitivity="input", sensitivity_bounds=(50.0, 800.0), alignment=alignment
        ).block(0.01)
        assert [s.name for s in block.inputs] == ["reference", "measured", "sensitivity"]
        np.testing.assert_array_equal(run(block, inputs)[:, Y_SENSITIVITY], expected)
