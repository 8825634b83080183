"""A synchronous generator behind a line to an infinite bus, controlled by its field voltage.

The plant of section 6 of Takata, Hachino & Komatsu (NOLTA): the classical swing equation, with the
rotor angle δ counted from where it rests without control, x = δ − δ_0, ω = dδ/dt,

    M dω/dt = P_in + ΔP_in − D ω − P_e (1 + u),     P_e = (e_l E_fd / X_e) sin(x + δ_0)

u = ΔE_fd/E_fd raises the field voltage, ΔP_in the turbine's power. The angle is not wrapped: a
machine that slips poles moves on by 2π a slip, and one that has slipped is not back where it was.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import asin
from types import SimpleNamespace

import casadi as ca

from fmus.declaration import DisplayUnit, Parameter, State, Variable
from fmus.linearization import WorkingPoint
from fmus.physics.smooth import Expression
from fmus.plant import Plant

PAPER = "Takata et al., section 6"

STATES = (
    State("angle_deviation", "rad", "rotor angle, from where it rests without control", 0.0, 1.0),
    State("speed", "rad/s", "rotor speed, from synchronous speed", 0.0, 1.0),
)

INPUTS = (
    Variable("field_deviation", "1", "change of the field voltage, as a share of it"),
    Variable("mechanical_power_deviation", "1", "change of the turbine's power, per unit"),
)

OUTPUTS = (
    Variable("angle_deviation", "rad", "rotor angle, from where it rests without control"),
    Variable("speed", "rad/s", "rotor speed, from synchronous speed; what is measured"),
    Variable("rotor_angle", "rad", "rotor angle, from the voltage of the infinite bus"),
    Variable("field_voltage", "1", "field voltage, per unit"),
    Variable("electrical_power", "1", "power given to the infinite bus, per unit"),
    Variable("accelerating_power", "1", "power that speeds up the rotor, per unit"),
    Variable("transient_energy", "rad", "kinetic and potential energy, 0 at rest, per unit"),
)

# fmt: off
PARAMETERS = (
    Parameter("inertia", "s2/rad", "inertia coefficient M, per unit",
              0.06, PAPER, 1e-4, 100.0),
    Parameter("damping", "s/rad", "damping coefficient D, per unit",
              0.06, PAPER, 0.0, 100.0),
    Parameter("nominal_field_voltage", "1", "field voltage E_fd without control, per unit",
              1.0, PAPER, 0.0, 10.0),
    Parameter("bus_voltage", "1", "voltage e_l of the infinite bus, per unit",
              1.0, PAPER, 0.0, 10.0),
    Parameter("line_reactance", "1", "impedance X_e between machine and bus, per unit",
              1.0, PAPER, 1e-3, 100.0),
    Parameter("mechanical_power", "1", "power P_in of the turbine, per unit",
              0.8, PAPER, -10.0, 10.0),
    Parameter("rest_angle", "rad", "angle δ_0 from which angle_deviation counts",
              asin(0.8), f"our choice: asin(0.8), where f(0) = 0; {PAPER} rounds it to 0.9276",
              -3.2, 3.2),
)
# fmt: on


def equations(
    x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
) -> tuple[Mapping[str, Expression], Mapping[str, Expression]]:
    """dx/dt by state and y by output, over CasADi scalars."""
    angle = x.angle_deviation + p.rest_angle
    strength = p.bus_voltage * p.nominal_field_voltage / p.line_reactance
    electrical = strength * ca.sin(angle) * (1 + u.field_deviation)
    mechanical = p.mechanical_power + u.mechanical_power_deviation
    accelerating = mechanical - p.damping * x.speed - electrical
    outputs = {
        "angle_deviation": x.angle_deviation,
        "speed": x.speed,
        "rotor_angle": angle,
        "field_voltage": p.nominal_field_voltage * (1 + u.field_deviation),
        "electrical_power": electrical,
        "accelerating_power": accelerating,
        "transient_energy": p.inertia * x.speed**2 / 2
        - p.mechanical_power * x.angle_deviation
        - strength * (ca.cos(angle) - ca.cos(p.rest_angle)),
    }
    return {"angle_deviation": x.speed, "speed": accelerating / p.inertia}, outputs


plant = Plant(
    name="single_machine_infinite_bus",
    description="Generator at an infinite bus, controlled by its field (Takata et al., section 6)",
    states=STATES,
    inputs=INPUTS,
    outputs=OUTPUTS,
    parameters=PARAMETERS,
    equations=equations,
    stop_time=10.0,
    display_units=(DisplayUnit("rad", "deg", 57.29577951308232),),
)

WORKING_POINTS = (
    WorkingPoint("at rest without control", (0.0, 0.0), "field_voltage", 1.0),
    WorkingPoint("field raised by 20 %", (0.0, 0.0), "field_voltage", 1.2),
    WorkingPoint("field lowered by 19 %, 1 % above losing synchronism", (0.0, 0.0),
                 "field_voltage", 0.81),
)  # fmt: skip
