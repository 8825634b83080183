"""One actuator axis: servo motor, pump, closed circuit with reservoir, asymmetric cylinder.

States x and parameters p come as namespaces, named by `fmus.physics.axis_interface`. With ω shaft
speed, T motor torque, y rod displacement from mid-stroke, v its speed, p_a and p_b absolute
chamber pressures, A_a and A_b piston areas, L stroke, F_L load force against extension:

    J dω/dt            = T − T_pump
    V_a (dρ/dp) dp_a/dt = Σṁ_a − ρ_a A_a v        V_a = V_a0 + A_a (L/2 + y)
    V_b (dρ/dp) dp_b/dt = Σṁ_b + ρ_b A_b v        V_b = V_b0 + A_b (L/2 − y)
    dy/dt              = v
    M dv/dt            = (p_a − p₀) A_a − (p_b − p₀) A_b − F_friction + F_stops − F_L

Positive ω pumps from B (rod side) to A (piston side) and extends the rod. The books of energy
close exactly:

    d(stored)/dt = T ω + h_r ṁ_reservoir − F_L v − Σ losses,      every loss ≥ 0.

Left out: temperature, line inertia, swash and piston ripple, electrical losses, gravity.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from types import SimpleNamespace

from fmus.physics.circuit import Circuit, circuit, circuit_losses
from fmus.physics.fluid import Oil
from fmus.physics.mechanics import EndStops, Friction
from fmus.physics.motor import ServoDrive
from fmus.physics.pump import Pump
from fmus.physics.smooth import Expression, saturate

COMMAND_WIDTH = 1e-3  # rounding of the command's limits ±1


@dataclass(frozen=True)
class Axis:
    """What `axis` computes: rates by state name, and the quantities that outputs are made of.

    Forces in N, powers in W, energy in J, mass in kg; `losses` by name, each ≥ 0.
    """

    rates: dict[str, Expression]
    flows: Circuit
    losses: dict[str, Expression]
    position: Expression
    pressure_force: Expression
    friction_force: Expression
    hydraulic_power: Expression
    reservoir_power: Expression
    stored_energy: Expression
    fluid_mass: Expression


@dataclass(frozen=True)
class _Components:
    """The components of an axis, filled from its parameters, and its geometry."""

    oil: Oil
    pump: Pump
    drive: ServoDrive
    friction: Friction
    stops: EndStops
    area_a: Expression
    area_b: Expression
    position: Expression
    volume_a: Expression
    volume_b: Expression


@dataclass(frozen=True)
class _Forces:
    """Forces on the rod in N."""

    pressure: Expression
    friction: Expression
    stop_elastic: Expression
    stop_damping: Expression


def axis(
    x: SimpleNamespace, p: SimpleNamespace, speed_command: Expression, load_force: Expression
) -> Axis:
    """Equations of one axis.

    `speed_command` is normalised (1 is the rated speed) and limited to ±1; `load_force` (N) acts
    against extension.
    """
    c = _components(x, p)
    flows = circuit(x, p, c.oil, c.pump)
    forces = _forces(x, p, c)
    rise = c.oil.enthalpy(x.chamber_pressure_a) - c.oil.enthalpy(x.chamber_pressure_b)
    mass_a = c.oil.density_at(x.chamber_pressure_a) * c.volume_a
    mass_b = c.oil.density_at(x.chamber_pressure_b) * c.volume_b
    return Axis(
        rates={
            **_drive_rates(x, p, c, speed_command),
            **_chamber_rates(x, c, flows),
            **_rod_rates(x, p, forces, load_force),
        },
        flows=flows,
        losses={
            "friction": forces.friction * x.rod_velocity,
            "end_stops": -forces.stop_damping * x.rod_velocity,
            **circuit_losses(x, p, c.oil, c.pump, flows),
        },
        position=c.position,
        pressure_force=forces.pressure,
        friction_force=forces.friction,
        hydraulic_power=flows.pumped * rise,
        reservoir_power=flows.reservoir * c.oil.enthalpy(p.reservoir_pressure),
        stored_energy=_stored_energy(x, p, c),
        fluid_mass=mass_a + mass_b,
    )


def _components(x: SimpleNamespace, p: SimpleNamespace) -> _Components:
    area_a = pi / 4 * p.piston_diameter**2
    area_b = area_a - pi / 4 * p.rod_diameter**2
    position = p.stroke / 2 + x.rod_displacement
    return _Components(
        oil=Oil(
            p.oil_density, p.bulk_modulus, p.air_fraction, p.atmospheric_pressure, p.vapour_pressure
        ),
        pump=Pump(p.pump_displacement / (2 * pi), p.pump_viscous_torque),
        drive=ServoDrive(
            torque_limit=p.torque_limit,
            power_limit=p.power_limit,
            torque_time_constant=p.torque_time_constant,
            speed_gain=p.speed_gain,
            speed_integral_time=p.speed_integral_time,
        ),
        friction=Friction(
            coulomb=p.coulomb_friction,
            breakaway=p.breakaway_friction,
            stribeck_speed=p.stribeck_speed,
            smoothing_speed=p.friction_smoothing_speed,
            viscous=p.viscous_friction,
        ),
        stops=EndStops(p.stroke, p.stop_stiffness, p.stop_damping),
        area_a=area_a,
        area_b=area_b,
        position=position,
        volume_a=p.dead_volume_a + area_a * position,
        volume_b=p.dead_volume_b + area_b * (p.stroke - position),
    )


def _forces(x: SimpleNamespace, p: SimpleNamespace, c: _Components) -> _Forces:
    gauge_a = x.chamber_pressure_a - p.atmospheric_pressure
    gauge_b = x.chamber_pressure_b - p.atmospheric_pressure
    return _Forces(
        pressure=gauge_a * c.area_a - gauge_b * c.area_b,
        friction=c.friction.force(x.rod_velocity),
        stop_elastic=c.stops.elastic_force(c.position),
        stop_damping=c.stops.damping_force(c.position, x.rod_velocity),
    )


def _drive_rates(
    x: SimpleNamespace, p: SimpleNamespace, c: _Components, speed_command: Expression
) -> dict[str, Expression]:
    reference = p.rated_speed * saturate(speed_command, COMMAND_WIDTH)
    torque_rate, integral_rate = c.drive.derivatives(
        reference, x.shaft_speed, x.air_gap_torque, x.speed_integral
    )
    load = c.pump.torque(x.shaft_speed, x.chamber_pressure_a, x.chamber_pressure_b)
    return {
        "shaft_speed": (x.air_gap_torque - load) / p.rotor_inertia,
        "air_gap_torque": torque_rate,
        "speed_integral": integral_rate,
    }


def _chamber_rates(x: SimpleNamespace, c: _Components, flows: Circuit) -> dict[str, Expression]:
    growth_a = c.area_a * x.rod_velocity
    growth_b = -c.area_b * x.rod_velocity
    return {
        "chamber_pressure_a": c.oil.pressure_rate(
            x.chamber_pressure_a, c.volume_a, flows.inflow_a, growth_a
        ),
        "chamber_pressure_b": c.oil.pressure_rate(
            x.chamber_pressure_b, c.volume_b, flows.inflow_b, growth_b
        ),
    }


def _rod_rates(
    x: SimpleNamespace, p: SimpleNamespace, forces: _Forces, load_force: Expression
) -> dict[str, Expression]:
    stops = forces.stop_elastic + forces.stop_damping
    return {
        "rod_displacement": x.rod_velocity,
        "rod_velocity": (forces.pressure - forces.friction + stops - load_force) / p.load_mass,
    }


def _stored_energy(x: SimpleNamespace, p: SimpleNamespace, c: _Components) -> Expression:
    kinetic = (p.rotor_inertia * x.shaft_speed**2 + p.load_mass * x.rod_velocity**2) / 2
    oil_a = c.oil.stored_energy(x.chamber_pressure_a, c.volume_a)
    oil_b = c.oil.stored_energy(x.chamber_pressure_b, c.volume_b)
    return kinetic + oil_a + oil_b + c.stops.stored_energy(c.position)
