"""What the plant tests share: simulation by Radau, random states, rates of a scalar along f."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from fmus.disturbance_generator.model import plant as disturbance_generator
from fmus.electro_hydraulic_servo.model import plant as electro_hydraulic_servo
from fmus.hybrid_actuator.model import plant as hybrid_actuator
from fmus.linearization import parameter_values, plant_functions
from fmus.oscillator_left.model import plant as oscillator_left
from fmus.oscillator_right.model import plant as oscillator_right
from fmus.plant import Plant
from fmus.single_machine_infinite_bus.model import plant as single_machine_infinite_bus
from fmus.two_mass_drive.model import plant as two_mass_drive

Array = NDArray[np.float64]
AXES = (hybrid_actuator, disturbance_generator)
PLANTS = (
    *AXES, electro_hydraulic_servo, single_machine_infinite_bus, two_mass_drive, oscillator_left,
    oscillator_right,
)  # fmt: skip
SAMPLE_TIME = 0.01

STATE_RANGES = {
    "shaft_speed": (-300.0, 300.0),
    "air_gap_torque": (-26.0, 26.0),
    "speed_integral": (-26.0, 26.0),
    "chamber_pressure_a": (2e3, 200e5),
    "chamber_pressure_b": (2e3, 200e5),
    "rod_displacement": (-0.0755, 0.0755),
    "rod_velocity": (-0.3, 0.3),
    "load_cell_force": (-5e4, 5e4),
    "position": (-0.05, 0.05),
    "velocity": (-0.1, 0.1),
    "load_pressure": (-95e5, 95e5),
    "spool_position": (-1e-5, 1e-5),
    "angle_deviation": (-4.0, 4.0),
    "speed": (-12.0, 12.0),
    "torque_loop": (-3.0, 3.0),
    "speed_1": (-1.5, 1.5),
    "speed_2": (-1.5, 1.5),
    "elastic_torque": (-3.0, 3.0),
    "angle_1": (-1e3, 1e3),
}
INPUT_RANGES = {
    "command": (-1.2, 1.2),
    "environment_position": (-0.05, 0.05),
    "environment_velocity": (-0.3, 0.3),
    "spring_force": (-3e4, 3e4),
    "current": (-2e-3, 2e-3),
    "current_error": (-1e-3, 1e-3),
    "load_force": (-1e3, 1e3),
    "field_deviation": (-10.0, 10.0),
    "mechanical_power_deviation": (-0.5, 0.5),
    "torque_reference": (-4.0, 4.0),
    "load_torque": (-1.5, 1.5),
    "load_time_constant": (0.01, 1.0),
    "coupling_force": (-20.0, 20.0),
    "left_position": (-0.2, 0.2),
    "left_velocity": (-2.0, 2.0),
}


def draw(plant: Plant, rng: np.random.Generator) -> tuple[Array, Array]:
    """A random state and input; absolute pressures log-uniform, so that thin oil is drawn too."""
    x = np.array([rng.uniform(*STATE_RANGES[s.name]) for s in plant.states])
    for i, state in enumerate(plant.states):
        if state.unit == "Pa" and STATE_RANGES[state.name][0] > 0.0:
            x[i] = np.exp(rng.uniform(*np.log(STATE_RANGES[state.name])))
    return x, np.array([rng.uniform(*INPUT_RANGES[v.name]) for v in plant.inputs])


@dataclass(frozen=True)
class Run:
    """Samples at k·Ts: time (N+1,), states (N+1, n), inputs and outputs at and held from k."""

    plant: Plant
    time: Array
    x: Array
    u: Array
    y: Array

    def state(self, name: str) -> Array:
        return self.x[:, [s.name for s in self.plant.states].index(name)]

    def output(self, name: str) -> Array:
        return self.y[:, [v.name for v in self.plant.outputs].index(name)]


class Simulator:
    """A plant stepped by Radau with exact Jacobian, inputs held over each sample."""

    def __init__(self, plant: Plant, changed: Mapping[str, float] | None = None) -> None:
        self.plant = plant
        self.p = parameter_values(plant, changed)
        self.f, self.h = plant_functions(plant)
        x, u = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs))
        self.jacobian = ca.Function("jac_x", [x, u], [ca.jacobian(self.f(x, u, self.p), x)])
        self.nominal = np.array([s.nominal for s in plant.states])
        self.start = np.array([s.start for s in plant.states])

    def rate(self, x: Array, u: Array) -> Array:
        return self.f(x, u, self.p).full().ravel()

    def outputs(self, x: Array, u: Array) -> Array:
        return self.h(x, u, self.p).full().ravel()

    def step(self, x: Array, u: Array, rtol: float, duration: float = SAMPLE_TIME) -> Array:
        solution = solve_ivp(
            lambda t, z: self.rate(z, u),
            (0.0, duration),
            x,
            method="Radau",
            jac=lambda t, z: self.jacobian(z, u).full(),
            rtol=rtol,
            atol=rtol * self.nominal,
        )
        assert solution.success, solution.message
        return solution.y[:, -1]

    def run(
        self,
        inputs: Callable[[float], tuple[float, ...]],
        stop_time: float,
        rtol: float = 1e-6,
        start: Mapping[str, float] | None = None,
    ) -> Run:
        names = [s.name for s in self.plant.states]
        x = self.start.copy()
        for name, value in (start or {}).items():
            x[names.index(name)] = value
        time = SAMPLE_TIME * np.arange(round(stop_time / SAMPLE_TIME) + 1)
        u = np.array([inputs(t) for t in time])
        states = [x]
        for held in u[:-1]:
            states.append(self.step(states[-1], held, rtol))
        y = np.array([self.outputs(a, b) for a, b in zip(states, u, strict=True)])
        return Run(self.plant, time, np.array(states), u, y)
