"""The estimator's f, Jacobian and noise gain are those of the plant, to 1e-9, and (14)'s."""

import casadi as ca
import numpy as np
import pytest

from controllers.core.block import Array
from controllers.core.errors import ControllerError
from controllers.papers.raheem2013.servo_model import (
    ServoParameters,
    servo_jacobian,
    servo_noise,
    servo_rate,
)
from fmus.electro_hydraulic_servo.model import plant
from fmus.linearization import parameter_values, plant_functions

SEED = 4
NOMINAL = np.array([0.01, 0.01, 1e6, 1e-6])
TOLERANCE = 1e-9


def plant_at(changed: dict[str, float]) -> ca.Function:
    """(x, u) -> f, ∂f/∂x, ∂f/∂(current_error, load_force)."""
    f, _ = plant_functions(plant)
    x, u = ca.SX.sym("x", 4), ca.SX.sym("u", 3)
    rate = f(x, u, parameter_values(plant, changed))
    return ca.Function("at", [x, u], [rate, ca.jacobian(rate, x), ca.jacobian(rate, u)[:, [1, 2]]])


def draw(rng: np.random.Generator) -> tuple[Array, Array]:
    """States near and far from closed valve, and beyond the supply pressure."""
    spool = rng.choice([-1.0, 1.0]) * 10 ** rng.uniform(-9, -5)
    pressure = rng.uniform(-1.2e7, 1.2e7)
    if rng.uniform() < 0.2:
        pressure = np.sign(spool) * (10342500.0 + rng.normal(0.0, 2e4))
    x = np.array([rng.uniform(-0.05, 0.05), rng.uniform(-0.1, 0.1), pressure, spool])
    return x, np.array([rng.uniform(-2e-3, 2e-3)])


@pytest.mark.parametrize("changed", [{}, {"spring_stiffness": 3e4, "bulk_modulus": 7e8}])
def test_rate_jacobian_and_noise_agree_with_casadi(changed: dict[str, float]) -> None:
    exact, rng = plant_at(changed), np.random.default_rng(SEED)
    p = ServoParameters(**changed).coefficients()
    rate, A, G = np.zeros(4), np.zeros(16), np.zeros(8)
    for _ in range(500):
        x, u = draw(rng)
        servo_rate(p, x, u, rate)
        servo_jacobian(p, x, u, A)
        servo_noise(p, x, u, G)
        f, f_x, f_w = (m.full() for m in exact(x, [u[0], 0.0, 0.0]))
        slopes = f_x * NOMINAL  # rate of each state per nominal of each
        terms = np.abs(slopes).sum(axis=1)
        assert np.all(np.abs(rate - f.ravel()) <= TOLERANCE * (np.abs(f.ravel()) + terms))
        assert np.all(np.abs(A.reshape(4, 4) * NOMINAL - slopes) <= TOLERANCE * terms[:, None])
        np.testing.assert_allclose(G.reshape(4, 2), f_w, rtol=TOLERANCE, atol=0.0)


@pytest.mark.parametrize("spool", [-4.5e-6, 4.5e-6])
@pytest.mark.parametrize("pressure", [-4e6, 5e5, 8e6])
def test_away_from_the_widths_the_jacobian_is_that_of_the_paper(
    spool: float, pressure: float
) -> None:
    """∂f₃/∂x₃ and ∂f₃/∂x₄ with sgn and √, widths a thousandth of what they are."""
    q = ServoParameters(spool_sign_width=1e-10, orifice_root_width=10.0)
    A = np.zeros(16)
    servo_jacobian(q.coefficients(), np.array([0.01, 0.0, pressure, spool]), np.zeros(1), A)
    stiffness = 4 * q.bulk_modulus / q.total_volume
    a34 = stiffness * q.discharge_coefficient * q.spool_gradient / np.sqrt(q.oil_density)
    root = np.sqrt(q.supply_pressure - np.sign(spool) * pressure)
    assert A[10] == pytest.approx(-stiffness * q.leakage - a34 * abs(spool) / (2 * root), rel=1e-8)
    assert A[11] == pytest.approx(a34 * root, rel=1e-8)
    first_rows = [0, 1, 0, 0, -q.spring_stiffness / 24, -60 / 24, q.piston_area / 24, 0]
    np.testing.assert_allclose(A[:8], first_rows, rtol=1e-14)


def test_defaults_are_those_of_the_plant() -> None:
    assert vars(ServoParameters()) == {q.name: q.value for q in plant.parameters}


def test_illegal_parameters_are_refused() -> None:
    with pytest.raises(ControllerError, match="bulk_modulus"):
        ServoParameters(bulk_modulus=0.0)
