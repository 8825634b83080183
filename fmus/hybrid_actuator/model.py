"""The hybrid actuator: one axis that compresses a spring, with a load cell at the spring.

Inputs: the normalised speed command, and the motion of the spring's far end (the environment).
The axis is `fmus.physics.electro_hydraulic_actuator`; the rest is

    δ   = y − y_free − x_env                      compression of the spring
    F_s = k (r δ + (1 − r) δ⁺) + c (v − v_env)    force on the environment, and back on the rod
    τ_s dF/dt = F_s − F                           load cell between load mass and spring
"""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace

from fmus.physics.axis_interface import (
    DISPLAY_UNITS,
    Value,
    axis_output_values,
    axis_outputs,
    axis_parameters,
    axis_states,
)
from fmus.physics.electro_hydraulic_actuator import Axis, axis
from fmus.physics.mechanics import CouplingSpring
from fmus.physics.smooth import Expression
from fmus.plant import Parameter, Plant, State, Variable

TABLE_1 = "Ahn & Truong 2009, Table 1"
TABLE_3 = "Ahn & Truong 2009, Table 3"

STATES = (
    *axis_states(),
    State("load_cell_force", "N", "force behind the load cell's amplifier", 0.0, 1e3),
)

INPUTS = (
    Variable("command", "1", "motor speed command, 1 is rated speed, limited to ±1"),
    Variable("environment_position", "m", "far end of the spring, positive away", nominal=1e-3),
    Variable("environment_velocity", "m/s", "speed of the spring's far end", nominal=0.01),
)

OUTPUTS = (
    Variable("force", "N", "controlled force, as the load cell reads it", nominal=1e3),
    Variable("force_signal", "V", "voltage of the load cell's amplifier", nominal=1.0),
    Variable("spring_force", "N", "true force on the environment, compression +", nominal=1e3),
    *axis_outputs(),
    Variable("environment_power", "W", "power given to the environment", nominal=100.0),
)

PARAMETERS = (
    *axis_parameters(
        {
            "torque_limit": Value(18.6, f"{TABLE_1} (rated torque)"),
            "power_limit": Value(2900.0, f"{TABLE_1} (2.9 kW)"),
            "rated_speed": Value(261.79938779914943, f"{TABLE_1} (2500 rev/min)"),
            "rotor_inertia": Value(6e-3, "our choice: 4.6e-3 for this motor size, and the pump"),
            "speed_gain": Value(0.9, "our choice: speed loop of 150 rad/s with this inertia"),
            "pump_displacement": Value(15e-6, f"{TABLE_1} (15 cm³/rev)"),
            "piston_diameter": Value(0.063, TABLE_1),
            "rod_diameter": Value(0.035, TABLE_1),
            "stroke": Value(0.150, TABLE_1),
            "load_mass": Value(1000.0, TABLE_1),
            "viscous_friction": Value(5000.0, "our choice: 1 kN at full speed, with the guide"),
        }
    ),
    Parameter(
        "spring_stiffness",
        "N/m",
        "spring between rod and environment",
        519e3,
        f"{TABLE_1} (519 kN/m)",
        0.0,
        1e9,
    ),
    Parameter(
        "spring_damping",
        "N.s/m",
        "damping of the spring",
        500.0,
        "our choice: 1 % of critical with the load mass",
        0.0,
        1e7,
    ),
    Parameter(
        "spring_tension_ratio",
        "1",
        "1: bolted at both ends, 0: lets go in tension",
        1.0,
        "our choice: the spring connects the two actuators (paper, section 3.2.1)",
        0.0,
        1.0,
    ),
    Parameter(
        "spring_free_displacement",
        "m",
        "rod displacement of the unloaded spring",
        0.0,
        "our choice: mid-stroke",
        -0.1,
        0.1,
    ),
    Parameter(
        "load_cell_time_constant",
        "s",
        "amplifier of the load cell",
        1e-3,
        "our choice: 160 Hz",
        1e-5,
        1.0,
    ),
    Parameter(
        "sensor_gain",
        "V/N",
        "voltage of the load cell's amplifier",
        3e-3,
        f"{TABLE_1} (3, unit not given); our choice of V/kN: 2000 N is 6 V of ±10 V",
        0.0,
        1.0,
    ),
)


def spring(p: SimpleNamespace) -> CouplingSpring:
    """The spring to the environment."""
    return CouplingSpring(p.spring_stiffness, p.spring_damping, p.spring_tension_ratio)


def assemble(x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> tuple[Axis, Expression]:
    """The axis under its spring, and the spring force in N."""
    compression = x.rod_displacement - p.spring_free_displacement - u.environment_position
    closing_speed = x.rod_velocity - u.environment_velocity
    force = spring(p).elastic_force(compression) + p.spring_damping * closing_speed
    return axis(x, p, u.command, force), force


def equations(
    x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
) -> tuple[Mapping[str, Expression], Mapping[str, Expression]]:
    """dx/dt and y, over CasADi scalars."""
    body, spring_force = assemble(x, u, p)
    compression = x.rod_displacement - p.spring_free_displacement - u.environment_position
    closing_speed = x.rod_velocity - u.environment_velocity
    rates = {
        **body.rates,
        "load_cell_force": (spring_force - x.load_cell_force) / p.load_cell_time_constant,
    }
    shared = axis_output_values(x, body, p.oil_density)
    outputs = {
        **shared,
        "force": x.load_cell_force,
        "force_signal": p.sensor_gain * x.load_cell_force,
        "spring_force": spring_force,
        "dissipated_power": shared["dissipated_power"] + p.spring_damping * closing_speed**2,
        "stored_energy": shared["stored_energy"] + spring(p).stored_energy(compression),
        "environment_power": spring_force * u.environment_velocity,
    }
    return rates, outputs


plant = Plant(
    name="hybrid_actuator",
    description="Electro-hydraulic actuator under force control (Ahn & Truong 2009, Table 1)",
    states=STATES,
    inputs=INPUTS,
    outputs=OUTPUTS,
    parameters=PARAMETERS,
    equations=equations,
    stop_time=2.0,
    display_units=DISPLAY_UNITS,
)
