"""Both plants on one spring, as one system: nothing is made or lost between them."""

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

from fmus.linearization import parameter_values, plant_functions
from tests.fmus.plants.bench import disturbance_generator, hybrid_actuator

RTOL = 1e-8
HYBRID, GENERATOR = len(hybrid_actuator.states), len(disturbance_generator.states)


def named(plant, y):
    return {v.name: y[i] for i, v in enumerate(plant.outputs)}


def coupled_system() -> tuple[ca.Function, ca.Function]:
    """z = (x_h, x_g, W, m): W integrates supply less losses, m what the reservoirs give.

    The far end of the spring is a state of the generator, so the coupling has no algebraic loop.
    """
    f_h, h_h = plant_functions(hybrid_actuator)
    f_g, h_g = plant_functions(disturbance_generator)
    p_h, p_g = parameter_values(hybrid_actuator), parameter_values(disturbance_generator)
    z, u = ca.SX.sym("z", HYBRID + GENERATOR + 2), ca.SX.sym("u", 2)
    x_h, x_g = z[:HYBRID], z[HYBRID : HYBRID + GENERATOR]
    end = named(disturbance_generator, h_g(x_g, ca.vertcat(u[1], 0), p_g))
    u_h = ca.vertcat(u[0], end["environment_position"], end["environment_velocity"])
    y_h = named(hybrid_actuator, h_h(x_h, u_h, p_h))
    u_g = ca.vertcat(u[1], y_h["spring_force"])
    y_g = named(disturbance_generator, h_g(x_g, u_g, p_g))

    def total(name: str) -> ca.SX:
        return y_h[name] + y_g[name]

    supply = total("motor_power") + total("reservoir_power") - total("dissipated_power")
    rates = ca.vertcat(f_h(x_h, u_h, p_h), f_g(x_g, u_g, p_g), supply, total("reservoir_flow"))
    crossing = y_h["environment_power"] - y_g["spring_power"]
    watched = ca.vertcat(total("stored_energy"), total("fluid_mass"), crossing, y_h["force"])
    return ca.Function("rates", [z, u], [rates]), ca.Function("watched", [z, u], [watched])


def test_energy_and_mass_of_the_coupled_plants_are_conserved():
    rates, watched = coupled_system()
    starts = [s.start for s in (*hybrid_actuator.states, *disturbance_generator.states)]
    nominals = [s.nominal for s in (*hybrid_actuator.states, *disturbance_generator.states)]
    z0 = np.array([*starts, 0.0, 0.0])

    def command(t: float) -> list[float]:
        return [0.1 * np.sin(6 * t), 0.3 * np.sin(20 * t)]

    z, u = ca.SX.sym("z", z0.size), ca.SX.sym("u", 2)
    jacobian = ca.Function("jac_z", [z, u], [ca.jacobian(rates(z, u), z)])
    solution = solve_ivp(
        lambda t, z: rates(z, command(t)).full().ravel(),
        (0.0, 0.5),
        z0,
        method="Radau",
        jac=lambda t, z: jacobian(z, command(t)).full(),
        rtol=RTOL,
        atol=RTOL * np.array([*nominals, 10.0, 1.0]),
    )
    first, last = (
        watched(solution.y[:, k], command(solution.t[k])).full().ravel() for k in (0, -1)
    )
    turned_over = np.abs(solution.y[-2:]).max(axis=1)
    assert turned_over[0] > 1.0
    assert turned_over[1] > 1e-3
    assert abs(last[0] - first[0] - solution.y[-2, -1]) < 1e-6 * turned_over[0]
    assert abs(last[1] - first[1] - solution.y[-1, -1]) < 1e-6 * turned_over[1]


def test_what_one_gives_to_the_spring_the_other_receives():
    _, watched = coupled_system()
    rng = np.random.default_rng(4)
    starts = [s.start for s in (*hybrid_actuator.states, *disturbance_generator.states)]
    nominals = [s.nominal for s in (*hybrid_actuator.states, *disturbance_generator.states)]
    for _ in range(50):
        moved = np.array(starts) + rng.uniform(-0.05, 0.05, len(starts)) * nominals
        crossing = watched([*moved, 0.0, 0.0], [0.0, 0.0]).full().ravel()[2]
        assert abs(crossing) < 1e-12
