"""The hybrid actuator: one axis that compresses a spring, with a load cell at the spring.

Inputs: the normalised speed command, and the motion of the spring's far end (the environment).
The axis is `fmus.physics.electro_hydraulic_actuator`; the rest is

    δ   = y − y_free − x_env                      compression of the spring
    F_s = k (r δ + (1 − r) δ⁺) + c (v − v_env)    force on the environment, and back on the rod
    τ_s dF/dt = F_s − F                           load cell between load mass and spring
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from types import SimpleNamespace

from fmus.declaration import Parameter, State, Variable
from fmus.linearization import WorkingPoint
from fmus.physics.axis_interface import (
    DISPLAY_UNITS,
    axis_output_values,
    axis_outputs,
    axis_states,
)
from fmus.physics.axis_parameters import Value, axis_parameters
from fmus.physics.electro_hydraulic_actuator import Axis, axis
from fmus.physics.mechanics import CouplingSpring
from fmus.physics.smooth import Expression
from fmus.plant import Plant

TABLE_1 = "Ahn & Truong 2009, Table 1"

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

AXIS_VALUES = {
    "torque_limit": Value(18.6, f"{TABLE_1} (rated torque)"),
    "power_limit": Value(2900.0, f"{TABLE_1} (2.9 kW)"),
    "rated_speed": Value(2500 * 2 * pi / 60, f"{TABLE_1} (2500 rev/min)"),
    "rotor_inertia": Value(6e-3, "our choice: 4.6e-3 for a motor of this size, and the pump"),
    "speed_gain": Value(0.9, "our choice: speed loop of 150 rad/s with this inertia"),
    "pump_displacement": Value(15e-6, f"{TABLE_1} (15 cm³/rev)"),
    "piston_diameter": Value(0.063, TABLE_1),
    "rod_diameter": Value(0.035, TABLE_1),
    "stroke": Value(0.150, TABLE_1),
    "load_mass": Value(1000.0, TABLE_1),
    "viscous_friction": Value(5000.0, "our choice: 1 kN at full speed, with the guide"),
}

# fmt: off
SPRING_AND_SENSOR = (
    Parameter("spring_stiffness", "N/m", "spring between rod and environment",
              519e3, f"{TABLE_1} (519 kN/m)", 0.0, 1e9),
    Parameter("spring_damping", "N.s/m", "damping of the spring",
              500.0, "our choice: 1 % of critical with the load mass", 0.0, 1e7),
    Parameter("spring_tension_ratio", "1", "1: bolted at both ends, 0: lets go in tension",
              1.0, "our choice: the spring connects the two actuators (section 3.2.1)", 0.0, 1.0),
    Parameter("spring_free_displacement", "m", "rod displacement of the unloaded spring",
              0.0, "our choice: mid-stroke", -0.1, 0.1),
    Parameter("load_cell_time_constant", "s", "amplifier of the load cell",
              1e-3, "our choice: 160 Hz", 1e-5, 1.0),
    Parameter("sensor_gain", "V/N", "voltage of the load cell's amplifier",
              3e-3, f"{TABLE_1} (3, no unit); our choice V/kN: 2000 N is 6 V of ±10 V", 0.0, 1.0),
)
# fmt: on


@dataclass(frozen=True)
class Assembly:
    """The axis under its spring; `losses` (W) are those of the axis and of the spring."""

    axis: Axis
    spring_force: Expression
    spring_energy: Expression
    losses: dict[str, Expression]


def assemble(x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Assembly:
    """Spring and axis, from states, inputs and parameters."""
    spring = CouplingSpring(p.spring_stiffness, p.spring_damping, p.spring_tension_ratio)
    compression = x.rod_displacement - p.spring_free_displacement - u.environment_position
    closing_speed = x.rod_velocity - u.environment_velocity
    damping_force = spring.damping_force(closing_speed)
    force = spring.elastic_force(compression) + damping_force
    body = axis(x, p, u.command, force)
    return Assembly(
        axis=body,
        spring_force=force,
        spring_energy=spring.stored_energy(compression),
        losses={**body.losses, "spring": damping_force * closing_speed},
    )


def equations(
    x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
) -> tuple[Mapping[str, Expression], Mapping[str, Expression]]:
    """dx/dt by state and y by output, over CasADi scalars."""
    whole = assemble(x, u, p)
    lag = (whole.spring_force - x.load_cell_force) / p.load_cell_time_constant
    outputs = {
        **axis_output_values(x, whole.axis, p.oil_density),
        "force": x.load_cell_force,
        "force_signal": p.sensor_gain * x.load_cell_force,
        "spring_force": whole.spring_force,
        "dissipated_power": sum(whole.losses.values()),
        "stored_energy": whole.axis.stored_energy + whole.spring_energy,
        "environment_power": whole.spring_force * u.environment_velocity,
    }
    return {**whole.axis.rates, "load_cell_force": lag}, outputs


plant = Plant(
    name="hybrid_actuator",
    description="Electro-hydraulic actuator under force control (Ahn & Truong 2009, Table 1)",
    states=STATES,
    inputs=INPUTS,
    outputs=OUTPUTS,
    parameters=(*axis_parameters(AXIS_VALUES), *SPRING_AND_SENSOR),
    equations=equations,
    stop_time=2.0,
    display_units=DISPLAY_UNITS,
)

WORKING_POINTS = (
    WorkingPoint("at rest without force", (0.0, 0.0, 0.0), "force", 0.0),
    WorkingPoint("holding 2000 N", (0.0, 0.0, 0.0), "force", 2000.0),
    WorkingPoint("holding 15 kN", (0.0, 0.0, 0.0), "force", 15e3),
)
