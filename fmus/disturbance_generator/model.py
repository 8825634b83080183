"""The disturbance generator: one axis that faces the hybrid actuator across the spring.

Its rod points at the other one, so extension moves the spring's end by −y. The command is a speed
command as in the paper; a weak centring loop in the drive keeps a zero-mean command from
drifting to an end stop (the axis integrates every offset):

    u_speed = command − K_c y
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from types import SimpleNamespace

from fmus.declaration import Parameter, Variable
from fmus.linearization import WorkingPoint
from fmus.physics.axis_interface import (
    DISPLAY_UNITS,
    axis_output_values,
    axis_outputs,
    axis_states,
)
from fmus.physics.axis_parameters import Value, axis_parameters
from fmus.physics.electro_hydraulic_actuator import Axis, axis
from fmus.physics.smooth import Expression
from fmus.plant import Plant

TABLE_3 = "Ahn & Truong 2009, Table 3"

INPUTS = (
    Variable("command", "1", "motor speed command, 1 is rated speed, limited to ±1"),
    Variable("spring_force", "N", "force of the spring on the rod, compression +", nominal=1e3),
)

OUTPUTS = (
    Variable("environment_position", "m", "the spring's end, as the other rod sees it", 0.0, 1e-3),
    Variable("environment_velocity", "m/s", "speed of the spring's end", nominal=0.01),
    Variable("piston_force", "N", "net pressure force on the piston", nominal=1e3),
    *axis_outputs(),
    Variable("spring_power", "W", "power that the spring gives to the rod", nominal=100.0),
)

AXIS_VALUES = {
    "torque_limit": Value(26.18, f"{TABLE_3} (rated torque)"),
    "power_limit": Value(2200.0, f"{TABLE_3} (2.2 kW)"),
    "rated_speed": Value(2000 * 2 * pi / 60, f"{TABLE_3} (2000 rev/min)"),
    "rotor_inertia": Value(8e-3, "our choice: a motor of this torque, and the pump"),
    "speed_gain": Value(1.2, "our choice: speed loop of 150 rad/s with this inertia"),
    "pump_displacement": Value(10e-6, f"{TABLE_3} (10 cm³/rev)"),
    "piston_diameter": Value(0.055, TABLE_3),
    "rod_diameter": Value(0.035, TABLE_3),
    "stroke": Value(0.100, TABLE_3),
    "load_mass": Value(50.0, "our choice: piston, rod and platen"),
    "viscous_friction": Value(2000.0, "our choice: seals only, 280 N at full speed"),
}

# fmt: off
CENTRING = (
    Parameter("centring_gain", "1/m", "command per displacement from mid-stroke",
              7.0, "our choice: returns in 1 s, below the disturbance's band; 0 is off", 0.0, 1e3),
)
# fmt: on


def assemble(x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Axis:
    """The axis under its centring loop."""
    return axis(x, p, u.command - p.centring_gain * x.rod_displacement, u.spring_force)


def equations(
    x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
) -> tuple[Mapping[str, Expression], Mapping[str, Expression]]:
    """dx/dt by state and y by output, over CasADi scalars."""
    body = assemble(x, u, p)
    outputs = {
        **axis_output_values(x, body, p.oil_density),
        "environment_position": -x.rod_displacement,
        "environment_velocity": -x.rod_velocity,
        "piston_force": body.pressure_force,
        "spring_power": -u.spring_force * x.rod_velocity,
    }
    return body.rates, outputs


plant = Plant(
    name="disturbance_generator",
    description="Actuator that moves the far end of the spring (Ahn & Truong 2009, Table 3)",
    states=axis_states(),
    inputs=INPUTS,
    outputs=OUTPUTS,
    parameters=(*axis_parameters(AXIS_VALUES), *CENTRING),
    equations=equations,
    stop_time=2.0,
    display_units=DISPLAY_UNITS,
)

WORKING_POINTS = (
    WorkingPoint("at rest without force", (0.0, 0.0), "position", 0.05),
    WorkingPoint("mid-stroke against 2000 N", (0.0, 2000.0), "position", 0.05),
)
