"""The two-mass drive: a motor that turns a load through an elastic shaft, in per-unit quantities.

Equations (1)–(3) of Serkies & Szabat 2013, behind an optimised torque loop:

    τ dm_e/dt   = clip(m_ref) − m_e                    torque loop, clip to ± the torque limit
    T_1 dω_1/dt = m_e − m_s − b_1 ω_1                                                        (1)
    T_2 dω_2/dt = m_s − m_L − b_2 ω_2                                                        (2)
    T_c dm_c/dt = ω_1 − ω_2,   m_s = m_c + d (ω_1 − ω_2)                                     (3)
    dθ/dt       = Ω_b ω_1                              angle of the motor, for an encoder

T_2 is an input: the inertia of the load may change during a run. A change leaves the speed as it
is, as when a flywheel that already turns at ω_2 is coupled; whoever couples it brings its energy.
No load is without inertia: below a floor the floor is taken.

This module refuses to know the dead time of the converter (a delay on the wire that carries the
torque reference) and the encoder's counts (a quantisation on the wire that carries the angle).
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from types import SimpleNamespace

from fmus.declaration import DisplayUnit, Parameter, State, Variable
from fmus.linearization import WorkingPoint
from fmus.physics.smooth import Expression, ramp
from fmus.plant import Plant

PAPER = "Serkies & Szabat 2013"
NOMINAL = 0.203

STATES = (
    State("torque_loop", "1", "m_e, torque behind the torque loop", 0.0, 1.0),
    State("speed_1", "1", "ω_1, speed of the motor", 0.0, 1.0),
    State("speed_2", "1", "ω_2, speed of the load", 0.0, 1.0),
    State("elastic_torque", "1", "m_c, elastic part of the shaft torque", 0.0, 1.0),
    State("angle_1", "rad", "θ, angle of the motor", 0.0, 100.0),
)

INPUTS = (
    Variable("torque_reference", "1", "m_ref, torque asked of the torque loop"),
    Variable("load_torque", "1", "m_L, taken from the load, against positive speed"),
    Variable("load_time_constant", "s", "T_2, mechanical time constant of the load, above 0",
             start=NOMINAL, nominal=0.1),
)  # fmt: skip

OUTPUTS = (
    Variable("motor_speed", "1", "ω_1, speed of the motor"),
    Variable("load_speed", "1", "ω_2, speed of the load"),
    Variable("shaft_torque", "1", "m_s, torque that the shaft gives to the load"),
    Variable("electromagnetic_torque", "1", "m_e, torque of the motor"),
    Variable("motor_angle", "rad", "θ, angle of the motor", nominal=100.0),
    Variable("motor_power", "1", "m_e ω_1, power that the motor gives"),
    Variable("load_power", "1", "m_L ω_2, power that the load takes"),
    Variable("dissipated_power", "1", "losses of both bearings and the shaft, never negative"),
    Variable("stored_energy", "s", "kinetic and elastic, in rated power times seconds"),
)

# fmt: off
PARAMETERS = (
    Parameter("motor_time_constant", "s", "T_1, mechanical time constant of the motor",
              NOMINAL, f"{PAPER}, section 4", 1e-4, 100.0),
    Parameter("shaft_time_constant", "s", "T_c, time constant of the shaft's stiffness",
              1.2e-3, f"{PAPER}, section 4", 1e-6, 1.0),
    Parameter("shaft_damping", "1", "d, damping of the shaft",
              0.0, f"{PAPER}, equation (3) has none", 0.0, 10.0),
    Parameter("motor_friction", "1", "b_1, viscous friction of the motor",
              0.0, f"{PAPER}, equation (1) has none", 0.0, 10.0),
    Parameter("load_friction", "1", "b_2, viscous friction of the load",
              0.0, f"{PAPER}, equation (2) has none", 0.0, 10.0),
    Parameter("smallest_load_time_constant", "s", "floor of T_2",
              2e-3, "our choice: a hundredth of the rated one, a bare shaft", 1e-5, 1.0),
    Parameter("torque_time_constant", "s", "τ, lag of the torque loop",
              1e-4, "our choice: with the converter's dead time, the modulus optimum's mean delay",
              1e-6, 0.1),
    Parameter("torque_limit", "1", "largest torque of the motor, either way",
              3.0, "our choice: usual short-time overload of a DC servo drive", 1e-3, 100.0),
    Parameter("limit_width", "1", "the corner of the limit is rounded over ± this",
              0.01, "our choice: exact outside, 0.3 % of the limit", 1e-6, 1.0),
    Parameter("base_speed", "rad/s", "Ω_b, speed of the motor at ω_1 = 1",
              1450 * 2 * pi / 60, "our choice: 1450 rev/min, usual for 500 W DC motors",
              1e-3, 1e4),
)
# fmt: on


def clip(x: Expression, limit: Expression, width: Expression) -> Expression:
    """x between ±limit, rounded within `width` of the corners and exact elsewhere; C²."""
    return x - ramp(x - limit, width) + ramp(-x - limit, width)


def held_above(x: Expression, floor: Expression) -> Expression:
    """x, or `floor` below it, rounded over ± half the floor and exact elsewhere; C²."""
    return floor + ramp(x - floor, floor / 2)


def equations(
    x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
) -> tuple[Mapping[str, Expression], Mapping[str, Expression]]:
    """dx/dt by state and y by output, over CasADi scalars."""
    slip = x.speed_1 - x.speed_2
    shaft_torque = x.elastic_torque + p.shaft_damping * slip
    T_2 = held_above(u.load_time_constant, p.smallest_load_time_constant)
    wanted = clip(u.torque_reference, p.torque_limit, p.limit_width)
    drive = x.torque_loop - shaft_torque - p.motor_friction * x.speed_1
    surplus = shaft_torque - u.load_torque - p.load_friction * x.speed_2
    rates = {
        "torque_loop": (wanted - x.torque_loop) / p.torque_time_constant,
        "speed_1": drive / p.motor_time_constant,
        "speed_2": surplus / T_2,
        "elastic_torque": slip / p.shaft_time_constant,
        "angle_1": p.base_speed * x.speed_1,
    }
    bearings = p.motor_friction * x.speed_1**2 + p.load_friction * x.speed_2**2
    kinetic = p.motor_time_constant * x.speed_1**2 + T_2 * x.speed_2**2
    outputs = {
        "motor_speed": x.speed_1,
        "load_speed": x.speed_2,
        "shaft_torque": shaft_torque,
        "electromagnetic_torque": x.torque_loop,
        "motor_angle": x.angle_1,
        "motor_power": x.torque_loop * x.speed_1,
        "load_power": u.load_torque * x.speed_2,
        "dissipated_power": bearings + p.shaft_damping * slip**2,
        "stored_energy": (kinetic + p.shaft_time_constant * x.elastic_torque**2) / 2,
    }
    return rates, outputs


plant = Plant(
    name="two_mass_drive",
    description="Two-mass drive with an elastic shaft (Serkies & Szabat 2013)",
    states=STATES,
    inputs=INPUTS,
    outputs=OUTPUTS,
    parameters=PARAMETERS,
    equations=equations,
    step_size=5e-4,
    stop_time=1.0,
    display_units=(DisplayUnit("rad/s", "rev/min", 60 / (2 * pi)),),
)

WORKING_POINTS = (
    WorkingPoint("at rest, rated inertia", (0.0, 0.0, NOMINAL), "motor_speed", 0.0),
    WorkingPoint("at rest, load inertia doubled", (0.0, 0.0, 2 * NOMINAL), "motor_speed", 0.0),
    WorkingPoint("at rest, load inertia halved", (0.0, 0.0, NOMINAL / 2), "motor_speed", 0.0),
)
