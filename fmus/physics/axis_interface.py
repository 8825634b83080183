"""States, parameters and outputs that every actuator axis has; each plant fills in its values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from fmus.physics.electro_hydraulic_actuator import Axis
from fmus.physics.smooth import Expression
from fmus.plant import DisplayUnit, Parameter, State, Variable

ATMOSPHERE = 101325.0  # Pa

DISPLAY_UNITS = (
    DisplayUnit("Pa", "bar", 1e-5),
    DisplayUnit("m", "mm", 1e3),
    DisplayUnit("N", "kN", 1e-3),
    DisplayUnit("rad/s", "rev/min", 9.549296585513721),
    DisplayUnit("m3/s", "l/min", 6e4),
    DisplayUnit("m3", "cm3", 1e6),
)


@dataclass(frozen=True)
class Value:
    """A plant's own value of a shared parameter, and where it comes from."""

    value: float
    source: str


def axis_states() -> tuple[State, ...]:
    """The states of an axis; the start is at rest, all at atmospheric pressure, mid-stroke."""
    return (
        State("shaft_speed", "rad/s", "speed of motor and pump", 0.0, 100.0),
        State("air_gap_torque", "N.m", "torque of the motor behind its torque loop", 0.0, 10.0),
        State("speed_integral", "N.m", "integral part of the drive's speed loop", 0.0, 10.0),
        State("chamber_pressure_a", "Pa", "piston side, absolute", ATMOSPHERE, 1e6),
        State("chamber_pressure_b", "Pa", "rod side, absolute", ATMOSPHERE, 1e6),
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


def axis_output_values(x: object, axis: Axis, density: Expression) -> dict[str, Expression]:
    """Values of `axis_outputs` by name; `x` is the namespace of states."""
    state = vars(x)
    return {
        "position": axis.position,
        "velocity": state["rod_velocity"],
        "pressure_a": state["chamber_pressure_a"],
        "pressure_b": state["chamber_pressure_b"],
        "motor_speed": state["shaft_speed"],
        "motor_torque": state["air_gap_torque"],
        "motor_power": state["air_gap_torque"] * state["shaft_speed"],
        "hydraulic_power": axis.hydraulic_power,
        "pump_flow": axis.pump_mass_flow / density,
        "make_up_flow_a": axis.line_a.make_up,
        "make_up_flow_b": axis.line_b.make_up,
        "pilot_flow_a": axis.line_a.pilot,
        "pilot_flow_b": axis.line_b.pilot,
        "relief_flow_a": axis.line_a.relief,
        "relief_flow_b": axis.line_b.relief,
        "reservoir_flow": axis.reservoir_mass_flow,
        "fluid_mass": axis.fluid_mass,
        "friction_force": axis.friction_force,
        "dissipated_power": sum(axis.losses.values()),
        "reservoir_power": axis.reservoir_power,
        "stored_energy": axis.stored_energy,
    }


def axis_parameters(values: Mapping[str, Value]) -> tuple[Parameter, ...]:
    """The parameters of an axis with a plant's `values` in place of the shared ones.

    Raises `ValueError` for a name that no parameter has, or a parameter left without a value.
    """
    shared = _shared_parameters()
    names = {parameter.name for parameter in shared}
    unknown = sorted(set(values) - names)
    if unknown:
        raise ValueError(f"axis has no parameters {unknown}; it has {sorted(names)}")
    filled = tuple(
        replace(q, value=values[q.name].value, source=values[q.name].source)
        if q.name in values
        else q
        for q in shared
    )
    missing = [q.name for q in filled if not q.source]
    if missing:
        raise ValueError(f"axis parameters {missing} differ by plant and need a value here")
    return filled


def _of_plant(name: str, unit: str, description: str) -> Parameter:
    """A positive parameter that each plant must give."""
    return Parameter(name, unit, description, 0.0, "", minimum=0.0)


def _shared_parameters() -> tuple[Parameter, ...]:
    return (*_drive_parameters(), *_cylinder_parameters(), *_valve_parameters(), *_oil_parameters())


def _drive_parameters() -> tuple[Parameter, ...]:
    return (
        _of_plant("torque_limit", "N.m", "torque limit of the motor"),
        _of_plant("power_limit", "W", "shaft power limit of the motor"),
        _of_plant("rated_speed", "rad/s", "motor speed at command 1"),
        _of_plant("rotor_inertia", "kg.m2", "motor, coupling and pump"),
        Parameter(
            "torque_time_constant",
            "s",
            "torque (current) loop of the drive",
            1.5e-3,
            "our choice: current loop of about 100 Hz, usual for servo drives",
            1e-5,
            1.0,
        ),
        _of_plant("speed_gain", "N.m.s/rad", "proportional gain of the speed loop"),
        Parameter(
            "speed_integral_time",
            "s",
            "integral time of the speed loop",
            0.04,
            "our choice: six times slower than the proportional loop",
            1e-4,
            100.0,
        ),
        _of_plant("pump_displacement", "m3", "pump displacement per revolution"),
        Parameter(
            "pump_viscous_torque",
            "N.m.s/rad",
            "viscous friction of the pump",
            4e-3,
            "our choice: 1 N.m at full speed, 6 % of rated torque",
            0.0,
            1.0,
        ),
        Parameter(
            "internal_leakage",
            "m3/(s.Pa)",
            "between the lines, pump and piston seal",
            2e-12,
            "our choice: 6 % of full flow at 175 bar, a good piston pump",
            0.0,
            1e-9,
        ),
        Parameter(
            "external_leakage",
            "m3/(s.Pa)",
            "from each line to the reservoir (case drain)",
            1e-12,
            "our choice: half the internal leakage",
            0.0,
            1e-9,
        ),
    )


def _cylinder_parameters() -> tuple[Parameter, ...]:
    return (
        _of_plant("piston_diameter", "m", "bore of the cylinder"),
        _of_plant("rod_diameter", "m", "rod of the cylinder"),
        _of_plant("stroke", "m", "travel between the end stops"),
        Parameter(
            "dead_volume_a",
            "m3",
            "line A, manifold and cylinder end",
            1e-4,
            "our choice: 0.5 m of 13 mm hose and a manifold",
            1e-6,
            0.1,
        ),
        Parameter(
            "dead_volume_b",
            "m3",
            "line B, manifold and cylinder end",
            1e-4,
            "our choice: as line A",
            1e-6,
            0.1,
        ),
        _of_plant("load_mass", "kg", "everything that moves with the rod"),
        Parameter(
            "coulomb_friction",
            "N",
            "dry friction of seals and guide",
            80.0,
            "our choice: about 1/4 bar on the piston",
            0.0,
            1e5,
        ),
        Parameter(
            "breakaway_friction",
            "N",
            "dry friction at low speed",
            120.0,
            "our choice: 1.5 times the dry friction",
            0.0,
            1e5,
        ),
        Parameter(
            "stribeck_speed",
            "m/s",
            "speed over which breakaway fades",
            0.01,
            "our choice: usual for cylinder seals",
            1e-6,
            1.0,
        ),
        Parameter(
            "friction_smoothing_speed",
            "m/s",
            "below it dry friction is viscous",
            1e-3,
            "our choice: 0.5 % of full rod speed",
            1e-6,
            1.0,
        ),
        _of_plant("viscous_friction", "N.s/m", "viscous friction of seals and guide"),
        Parameter(
            "stop_stiffness",
            "N/m",
            "stiffness of the end stops",
            2e8,
            "our choice: 0.3 mm under the greatest piston force",
            1e3,
            1e12,
        ),
        Parameter(
            "stop_damping",
            "N.s/m",
            "damping inside the end stops",
            2e5,
            "our choice: a cushion, a quarter of critical for 1000 kg",
            0.0,
            1e9,
        ),
    )


def _valve_parameters() -> tuple[Parameter, ...]:
    return (
        Parameter(
            "reservoir_pressure",
            "Pa",
            "absolute, constant",
            ATMOSPHERE,
            "our choice: vented, so that rest is force-free",
            1e3,
            1e7,
        ),
        Parameter(
            "make_up_cracking_pressure",
            "Pa",
            "make-up valves open above it",
            1e4,
            "our choice: weak spring against cavitation",
            0.0,
            1e6,
        ),
        Parameter(
            "make_up_opening_pressure",
            "Pa",
            "further difference to full opening",
            3e4,
            "our choice",
            1e2,
            1e7,
        ),
        Parameter(
            "make_up_rated_flow",
            "m3/s",
            "fully open, at 1 bar",
            8e-4,
            "our choice: 48 l/min, more than full pump flow",
            0.0,
            1.0,
        ),
        Parameter(
            "pilot_cracking_pressure",
            "Pa",
            "pilot-operated valves open above it",
            1e5,
            "our choice: closed at rest, open from 80 N on",
            0.0,
            1e7,
        ),
        Parameter(
            "pilot_opening_pressure",
            "Pa",
            "further balance to full opening",
            3e5,
            "our choice: wide, against hunting near zero force",
            1e2,
            1e8,
        ),
        Parameter(
            "pilot_area_ratio",
            "1",
            "pilot piston over seat",
            4.0,
            "our choice: catalogue values are 3 to 4.5",
            0.0,
            20.0,
        ),
        Parameter(
            "pilot_rated_flow",
            "m3/s",
            "fully open, at 1 bar",
            8e-4,
            "our choice: as the make-up valves",
            0.0,
            1.0,
        ),
        Parameter(
            "relief_cracking_pressure",
            "Pa",
            "above reservoir",
            175e5,
            "Ahn & Truong 2009, Tables 1 and 3 (175 bar)",
            1e4,
            1e8,
        ),
        Parameter(
            "relief_gradient",
            "m3/(s.Pa)",
            "flow over excess pressure",
            4.2e-10,
            "our choice: full pump flow at 15 bar above cracking",
            0.0,
            1e-6,
        ),
    )


def _oil_parameters() -> tuple[Parameter, ...]:
    return (
        Parameter(
            "oil_density",
            "kg/m3",
            "at atmospheric pressure",
            870.0,
            "Ahn & Truong 2009, Table 1 (specific gravity 0.87)",
            1.0,
            1e4,
        ),
        Parameter(
            "bulk_modulus",
            "Pa",
            "of the liquid",
            1.5e9,
            "Ahn & Truong 2009, Table 1",
            1e6,
            1e11,
        ),
        Parameter(
            "air_fraction",
            "1",
            "free air by volume at atmospheric pressure",
            1e-3,
            "our choice: a well bled circuit",
            1e-6,
            0.2,
        ),
        Parameter(
            "atmospheric_pressure",
            "Pa",
            "outside, and reference of the density",
            ATMOSPHERE,
            "standard atmosphere",
            1e3,
            1e6,
        ),
        Parameter(
            "vapour_pressure",
            "Pa",
            "no chamber falls below it",
            500.0,
            "our choice: above that of clean mineral oil, which is a few Pa",
            0.0,
            1e4,
        ),
    )
