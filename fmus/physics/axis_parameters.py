"""Parameters that every actuator axis has; each plant fills in those that are its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from fmus.declaration import Parameter

ATMOSPHERE = 101325.0  # Pa
TABLES = "Ahn & Truong 2009, Tables 1 and 3"


@dataclass(frozen=True)
class Value:
    """A plant's own value of a shared parameter, and where it comes from."""

    value: float
    source: str


def axis_parameters(values: Mapping[str, Value]) -> tuple[Parameter, ...]:
    """The parameters of an axis, with a plant's `values` put in.

    Raises `ValueError` for a name that no parameter has, and for a parameter without a value.
    """
    shared = (*DRIVE, *CYLINDER, *VALVES, *OIL)
    names = {parameter.name for parameter in shared}
    unknown = sorted(set(values) - names)
    if unknown:
        raise ValueError(f"an axis has no parameters {unknown}; it has {sorted(names)}")
    missing = sorted(q.name for q in shared if not q.source and q.name not in values)
    if missing:
        raise ValueError(f"axis parameters {missing} differ by plant: give each a Value")
    return tuple(
        replace(q, value=values[q.name].value, source=values[q.name].source)
        if q.name in values
        else q
        for q in shared
    )


# One parameter in two lines each, so that the tables can be read as tables. An empty source
# marks a value that differs by plant.
# fmt: off
DRIVE = (
    Parameter("torque_limit", "N.m", "torque limit of the motor",
              0.0, "", 0.01, 1e5),
    Parameter("power_limit", "W", "limit of the motor's shaft power",
              0.0, "", 1.0, 1e7),
    Parameter("rated_speed", "rad/s", "motor speed at command 1",
              0.0, "", 1.0, 1e4),
    Parameter("rotor_inertia", "kg.m2", "motor, coupling and pump",
              0.0, "", 1e-6, 100.0),
    Parameter("torque_time_constant", "s", "torque (current) loop of the drive",
              1.5e-3, "our choice: about 100 Hz, usual for servo drives", 1e-5, 1.0),
    Parameter("speed_gain", "N.m.s/rad", "proportional gain of the drive's speed loop",
              0.0, "", 0.0, 1e4),
    Parameter("speed_integral_time", "s", "integral time of the drive's speed loop",
              0.04, "our choice: six times slower than the proportional loop", 1e-4, 100.0),
    Parameter("pump_displacement", "m3", "pump displacement per revolution",
              0.0, "", 1e-9, 1e-2, False),
    Parameter("pump_viscous_torque", "N.m.s/rad", "viscous friction of the pump",
              4e-3, "our choice: 1 N·m at 2500 rev/min", 0.0, 10.0),
    Parameter("internal_leakage", "m3/(s.Pa)", "between the lines: pump and piston seal",
              2e-12, "our choice: 6 % of full flow at 175 bar, a good piston pump", 0.0, 1e-8),
    Parameter("external_leakage", "m3/(s.Pa)", "from each line to the reservoir: case drain",
              1e-12, "our choice: half the internal leakage", 0.0, 1e-8),
)

CYLINDER = (
    Parameter("piston_diameter", "m", "bore of the cylinder",
              0.0, "", 1e-3, 1.0, False),
    Parameter("rod_diameter", "m", "rod of the cylinder",
              0.0, "", 0.0, 1.0, False),
    Parameter("stroke", "m", "travel between the end stops",
              0.0, "", 1e-3, 10.0, False),
    Parameter("dead_volume_a", "m3", "line A, manifold and cylinder end",
              1e-4, "our choice: half a metre of 13 mm hose, and a manifold", 1e-6, 0.1, False),
    Parameter("dead_volume_b", "m3", "line B, manifold and cylinder end",
              1e-4, "our choice: as line A", 1e-6, 0.1, False),
    Parameter("load_mass", "kg", "everything that moves with the rod",
              0.0, "", 0.1, 1e6),
    Parameter("coulomb_friction", "N", "dry friction of seals and guide",
              80.0, "our choice: 1/4 bar on the piston", 0.0, 1e5),
    Parameter("breakaway_friction", "N", "dry friction at low speed",
              120.0, "our choice: 1.5 times the dry friction", 0.0, 1e5),
    Parameter("stribeck_speed", "m/s", "speed over which breakaway fades",
              0.01, "our choice: usual for cylinder seals", 1e-6, 1.0),
    Parameter("friction_smoothing_speed", "m/s", "below it dry friction acts as viscous",
              1e-3, "our choice: 0.5 % of full rod speed", 1e-6, 1.0),
    Parameter("viscous_friction", "N.s/m", "viscous friction of seals and guide",
              0.0, "", 0.0, 1e7),
    Parameter("stop_stiffness", "N/m", "stiffness of the end stops",
              2e8, "our choice: 0.3 mm under the greatest piston force", 1e3, 1e12),
    Parameter("stop_damping", "N.s/m", "damping inside the end stops",
              2e5, "our choice: a cushion, 22 % of critical for 1000 kg", 0.0, 1e9),
)

VALVES = (
    Parameter("reservoir_pressure", "Pa", "absolute and constant",
              ATMOSPHERE, "our choice: vented, so that rest is free of force", 2e4, 1e7),
    Parameter("make_up_cracking_pressure", "Pa", "make-up valves open above it",
              1e4, "our choice: weak spring, against cavitation", 0.0, 1e6),
    Parameter("make_up_opening_pressure", "Pa", "further difference to full opening",
              3e4, "our choice: fully open at 0.4 bar", 1e2, 1e7),
    Parameter("make_up_rated_flow", "m3/s", "make-up valve fully open, at 1 bar",
              8e-4, "our choice: 48 l/min, above full pump flow", 0.0, 1.0),
    Parameter("pilot_cracking_pressure", "Pa", "pilot-operated valves open above it",
              1e5, "our choice: closed at rest, open under some 100 N", 0.0, 1e7),
    Parameter("pilot_opening_pressure", "Pa", "further force balance to full opening",
              3e5, "our choice: wide, against hunting near zero force", 1e2, 1e8),
    Parameter("pilot_area_ratio", "1", "pilot piston over seat",
              4.0, "our choice: catalogues have 3 to 4.5", 0.0, 20.0),
    Parameter("pilot_rated_flow", "m3/s", "pilot-operated valve fully open, at 1 bar",
              8e-4, "our choice: as the make-up valves", 0.0, 1.0),
    Parameter("relief_cracking_pressure", "Pa", "above the reservoir",
              175e5, f"{TABLES} (175 bar)", 1e4, 1e8),
    Parameter("relief_gradient", "m3/(s.Pa)", "flow over excess pressure",
              4.2e-10, "our choice: full pump flow 15 bar above cracking", 0.0, 1e-6),
)

OIL = (
    Parameter("oil_density", "kg/m3", "at atmospheric pressure",
              870.0, "Ahn & Truong 2009, Table 1 (specific gravity 0.87)", 1.0, 1e4),
    Parameter("bulk_modulus", "Pa", "of the liquid",
              1.5e9, "Ahn & Truong 2009, Table 1", 1e7, 1e11),
    Parameter("air_fraction", "1", "free air by volume at atmospheric pressure",
              1e-3, "our choice: a well bled circuit", 1e-6, 0.2),
    Parameter("atmospheric_pressure", "Pa", "outside, and reference of the density",
              ATMOSPHERE, "standard atmosphere", 2e4, 1e6),
    Parameter("vapour_pressure", "Pa", "no chamber falls below it",
              500.0, "our choice: above that of clean mineral oil, a few Pa", 0.0, 1e4),
)
# fmt: on
