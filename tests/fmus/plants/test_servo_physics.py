"""The electro-hydraulic servo: energy book, regularisation, and the figures of its README."""

import casadi as ca
import numpy as np
import pytest

from fmus.electro_hydraulic_servo.model import plant
from fmus.linearization import equilibrium, linearize, parameter_values, plant_functions
from tests.fmus.plants.bench import Simulator, draw

SEED = 5
p = {q.name: q.value for q in plant.parameters}
outputs = [v.name for v in plant.outputs]


def test_stored_energy_changes_by_what_the_valve_gives_less_losses() -> None:
    f, h = plant_functions(plant)
    values = parameter_values(plant)
    x, u = ca.SX.sym("x", 4), ca.SX.sym("u", 3)
    y = h(x, u, values)
    rate = ca.jacobian(y[outputs.index("stored_energy")], x) @ f(x, u, values)
    along = ca.Function("along", [x, u], [rate, y])
    rng = np.random.default_rng(SEED)
    for _ in range(300):
        stored, shown = along(*draw(plant, rng))
        named = dict(zip(outputs, shown.full().ravel(), strict=True))
        expected = named["valve_power"] - named["dissipated_power"] - named["load_power"]
        size = abs(named["valve_power"]) + named["dissipated_power"] + abs(named["load_power"])
        assert abs(float(stored) - expected) < 1e-10 * (size + 100.0)


def flow(spool: float, pressure: float) -> float:
    _, h = plant_functions(plant)
    y = h([0.0, 0.0, pressure, spool], [0.0] * 3, parameter_values(plant))
    return float(y[outputs.index("load_flow")])


def printed_flow(spool: float, pressure: float) -> float:
    drop = p["supply_pressure"] - np.sign(spool) * pressure
    scale = p["discharge_coefficient"] * p["spool_gradient"]
    return float(scale * spool * np.sqrt(drop / p["oil_density"]))


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("pressure", [-8e6, -1e6, 0.0, 3e6, 8e6])
def test_away_from_its_widths_the_valve_is_that_of_equation_3(sign: float, pressure: float) -> None:
    """sgn is off by δ²/(2x²), the root by ε²/(4Δp²), relatively."""
    spool = sign * 4.5e-6
    drop = p["supply_pressure"] - sign * pressure
    share = abs(pressure) / drop * (p["spool_sign_width"] / spool) ** 2 / 4
    bound = share + (p["orifice_root_width"] / drop) ** 2 / 4 + 1e-12
    exact = printed_flow(spool, pressure)
    assert abs(flow(spool, pressure) / exact - 1.0) < 1.01 * bound


def test_flow_turns_back_above_the_supply_pressure_and_is_odd() -> None:
    assert flow(4e-6, 1.2e7) < 0.0 < flow(4e-6, 1.0e7)
    for spool, pressure in ((3e-8, 2e6), (4e-6, 1.2e7), (1e-6, -5e6)):
        assert flow(-spool, -pressure) == -flow(spool, pressure)


def test_a_millampere_holds_the_load_where_flow_is_leakage() -> None:
    x, u = equilibrium(plant, (0.0, 0.0, 0.0), "position", 0.05)
    pressure = p["spring_stiffness"] * 0.05 / p["piston_area"]
    assert x[2] == pytest.approx(pressure, rel=1e-10)
    assert flow(x[3], x[2]) == pytest.approx(p["leakage"] * pressure, rel=1e-9)
    assert x[3] == pytest.approx(p["valve_gain"] * u[0], rel=1e-12)


def test_eigenvalues_at_rest_are_those_of_the_hydraulic_spring() -> None:
    """Leakage moves the hydraulic pair and makes the slow pole, both as a small perturbation."""
    rest = linearize(plant, np.zeros(4), np.zeros(3)).eigenvalues()
    stiffness = 4 * p["bulk_modulus"] * p["piston_area"] ** 2 / p["total_volume"]
    omega = np.sqrt((stiffness + p["spring_stiffness"]) / p["load_mass"])
    assert -rest[0].real == pytest.approx(
        p["spring_stiffness"] * p["leakage"] / p["piston_area"] ** 2, rel=5e-3
    )
    assert rest[1] == pytest.approx(-1 / p["valve_time_constant"])
    assert abs(rest[2]) == pytest.approx(omega, rel=2e-3)


def test_one_milliampere_moves_the_load_as_the_readme_says() -> None:
    run = Simulator(plant).run(lambda t: (1e-3, 0.0, 0.0), 0.95)
    assert run.state("position")[-1] == pytest.approx(0.016, abs=5e-4)
