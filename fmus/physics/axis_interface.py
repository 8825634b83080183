"""States and outputs that every actuator axis has, and how people read its units."""

from __future__ import annotations

from types import SimpleNamespace

from fmus.declaration import DisplayUnit, State, Variable
from fmus.physics.axis_parameters import ATMOSPHERE
from fmus.physics.electro_hydraulic_actuator import Axis
from fmus.physics.smooth import Expression

DISPLAY_UNITS = (
    DisplayUnit("Pa", "bar", 1e-5),
    DisplayUnit("m", "mm", 1e3),
    DisplayUnit("N", "kN", 1e-3),
    DisplayUnit("rad/s", "rev/min", 9.549296585513721),
    DisplayUnit("m3/s", "l/min", 6e4),
    DisplayUnit("m3", "cm3", 1e6),
)


def axis_states() -> tuple[State, ...]:
    """The states of an axis; the start is at rest, all at atmospheric pressure, mid-stroke."""
    return (
        State("shaft_speed", "rad/s", "speed of motor and pump", 0.0, 100.0),
        State("air_gap_torque", "N.m", "torque of the motor behind its torque loop", 0.0, 10.0),
        State("speed_integral", "N.m", "integral part of the drive's speed loop", 0.0, 10.0),
        # 1e5: free air makes oil near 1 bar so soft that an error of mass there, pumped up, becomes
        # one of pressure a hundred times as large
        State("chamber_pressure_a", "Pa", "piston side, absolute", ATMOSPHERE, 1e5),
        State("chamber_pressure_b", "Pa", "rod side, absolute", ATMOSPHERE, 1e5),
        State("rod_displacement", "m", "from mid-stroke, positive in extension", 0.0, 1e-3),
        State("rod_velocity", "m/s", "positive in extension", 0.0, 1e-2),
    )


def axis_outputs() -> tuple[Variable, ...]:
    """The outputs of an axis, in the order of `axis_output_values`."""
    return (
        Variable("position", "m", "extension of the rod, 0 to stroke", nominal=0.1),
        Variable("velocity", "m/s", "speed of the rod", nominal=0.01),
        Variable("pressure_a", "Pa", "piston-side pressure, absolute", nominal=1e6),
        Variable("pressure_b", "Pa", "rod-side pressure, absolute", nominal=1e6),
        Variable("motor_speed", "rad/s", "speed of motor and pump", nominal=100.0),
        Variable("motor_torque", "N.m", "torque of the motor", nominal=10.0),
        Variable("motor_power", "W", "shaft power of the motor", nominal=1e3),
        Variable("hydraulic_power", "W", "power that the pump gives to the oil", nominal=1e3),
        Variable("pump_flow", "m3/s", "from B to A, at reference density", nominal=1e-4),
        Variable("make_up_flow_a", "m3/s", "reservoir to A by the make-up valve", nominal=1e-5),
        Variable("make_up_flow_b", "m3/s", "reservoir to B by the make-up valve", nominal=1e-5),
        Variable("pilot_flow_a", "m3/s", "reservoir to A by the pilot valve", nominal=1e-5),
        Variable("pilot_flow_b", "m3/s", "reservoir to B by the pilot valve", nominal=1e-5),
        Variable("relief_flow_a", "m3/s", "A to reservoir by the relief valve", nominal=1e-5),
        Variable("relief_flow_b", "m3/s", "B to reservoir by the relief valve", nominal=1e-5),
        Variable("reservoir_flow", "kg/s", "net mass flow from the reservoir", nominal=0.01),
        Variable("fluid_mass", "kg", "oil in both chambers", nominal=1.0),
        Variable("friction_force", "N", "cylinder friction, against motion", nominal=100.0),
        Variable("dissipated_power", "W", "sum of all losses, never negative", nominal=1e3),
        Variable("reservoir_power", "W", "energy flow from the reservoir", nominal=100.0),
        Variable("stored_energy", "J", "kinetic, elastic and in compressed oil", nominal=10.0),
    )


def axis_output_values(
    x: SimpleNamespace, axis: Axis, density: Expression
) -> dict[str, Expression]:
    """Values of `axis_outputs` by name, from states, axis and reference density (kg/m³)."""
    a, b = axis.flows.line_a, axis.flows.line_b
    return {
        "position": axis.position,
        "velocity": x.rod_velocity,
        "pressure_a": x.chamber_pressure_a,
        "pressure_b": x.chamber_pressure_b,
        "motor_speed": x.shaft_speed,
        "motor_torque": x.air_gap_torque,
        "motor_power": x.air_gap_torque * x.shaft_speed,
        "hydraulic_power": axis.hydraulic_power,
        "pump_flow": axis.flows.pumped / density,
        "make_up_flow_a": a.make_up,
        "make_up_flow_b": b.make_up,
        "pilot_flow_a": a.pilot,
        "pilot_flow_b": b.pilot,
        "relief_flow_a": a.relief,
        "relief_flow_b": b.relief,
        "reservoir_flow": axis.flows.reservoir,
        "fluid_mass": axis.fluid_mass,
        "friction_force": axis.friction_force,
        "dissipated_power": sum(axis.losses.values()),
        "reservoir_power": axis.reservoir_power,
        "stored_energy": axis.stored_energy,
    }
