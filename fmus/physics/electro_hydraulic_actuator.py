"""One actuator axis: servo motor, pump, closed circuit with reservoir, asymmetric cylinder.

States (x) and parameters (p) come as namespaces; `axis_states` and `axis_parameters` name them.
With ω shaft speed, T motor torque, y rod displacement from mid-stroke, v its speed, p_i absolute
chamber pressure, F_L load force against extension:

    J dω/dt   = T − T_pump
    V_a/(dp/dρ)_a dp_a/dt = Σṁ_a − ρ_a A_a v,     V_a = V_a0 + A_a (L/2 + y)
    V_b/(dp/dρ)_b dp_b/dt = Σṁ_b + ρ_b A_b v,     V_b = V_b0 + A_b (L/2 − y)
    Σṁ_i      = ±ṁ_pump ∓ ρ₀ C_i (p_a − p_b) + ρ₀ (Q_make-up + Q_pilot − Q_relief − C_e (p_i − p_r))
    M dv/dt   = (p_a − p₀) A_a − (p_b − p₀) A_b − F_friction + F_stops − F_L

Leak and valve flows are volumes at reference density ρ₀. Positive ω pumps from B (rod side) to A
(piston side) and extends the rod. The energy books close exactly:

    d(stored)/dt = T ω + h_r ṁ_reservoir − F_L v − Σ losses,      every loss ≥ 0.

Left out: temperature, line inertia, swash and piston ripple, electrical losses.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

from fmus.physics.fluid import Oil
from fmus.physics.mechanics import EndStops, Friction
from fmus.physics.motor import ServoDrive
from fmus.physics.pump import Pump
from fmus.physics.smooth import Expression, saturate
from fmus.physics.valves import check_valve, pilot_check_valve, relief_valve

COMMAND_WIDTH = 1e-3  # rounding of the command's limits ±1
REVOLUTION = 6.283185307179586  # rad
QUARTER_PI = 0.7853981633974483
RATING_PRESSURE = 1e5  # Pa; valve sizes are flows at this difference


@dataclass(frozen=True)
class Line:
    """Volume flows (m³/s, at reference density) between one line and the reservoir.

    `make_up` and `pilot` into the line, `relief` and `leakage` out of it.
    """

    make_up: Expression
    pilot: Expression
    relief: Expression
    leakage: Expression

    @property
    def inflow(self) -> Expression:
        """Net flow into the line."""
        return self.make_up + self.pilot - self.relief - self.leakage


@dataclass(frozen=True)
class Axis:
    """What `axis` computes: rates by state name, and the quantities that outputs are made of.

    Forces in N, flows in m³/s at reference density, powers in W, energy in J, mass in kg.
    """

    rates: dict[str, Expression]
    position: Expression
    line_a: Line
    line_b: Line
    pump_mass_flow: Expression
    hydraulic_power: Expression
    reservoir_mass_flow: Expression
    reservoir_power: Expression
    fluid_mass: Expression
    stored_energy: Expression
    losses: dict[str, Expression]
    friction_force: Expression
    pressure_force: Expression


@dataclass(frozen=True)
class _Components:
    """The components of an axis, filled from its parameters."""

    oil: Oil
    pump: Pump
    drive: ServoDrive
    friction: Friction
    stops: EndStops
    area_a: Expression
    area_b: Expression


def _components(p: SimpleNamespace) -> _Components:
    area_a = QUARTER_PI * p.piston_diameter**2
    return _Components(
        oil=Oil(
            density=p.oil_density,
            bulk_modulus=p.bulk_modulus,
            air_fraction=p.air_fraction,
            reference_pressure=p.atmospheric_pressure,
            vapour_pressure=p.vapour_pressure,
        ),
        pump=Pump(p.pump_displacement / REVOLUTION, p.pump_viscous_torque),
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
        area_b=area_a - QUARTER_PI * p.rod_diameter**2,
    )


def _line(p: SimpleNamespace, pressure: Expression, opposite: Expression) -> Line:
    suction = p.reservoir_pressure - pressure
    return Line(
        make_up=check_valve(
            suction,
            p.make_up_cracking_pressure,
            p.make_up_opening_pressure,
            p.make_up_rated_flow / RATING_PRESSURE**0.5,
        ),
        pilot=pilot_check_valve(
            suction,
            opposite - p.reservoir_pressure,
            p.pilot_area_ratio,
            p.pilot_cracking_pressure,
            p.pilot_opening_pressure,
            p.pilot_rated_flow / RATING_PRESSURE**0.5,
        ),
        relief=relief_valve(-suction, p.relief_cracking_pressure, p.relief_gradient),
        leakage=-p.external_leakage * suction,
    )


def _losses(
    x: SimpleNamespace, p: SimpleNamespace, c: _Components, line_a: Line, line_b: Line
) -> dict[str, Expression]:
    """Each dissipation in W by name; every one is ≥ 0."""
    h_a = c.oil.enthalpy(x.chamber_pressure_a)
    h_b = c.oil.enthalpy(x.chamber_pressure_b)
    h_r = c.oil.enthalpy(p.reservoir_pressure)
    position = p.stroke / 2 + x.rod_displacement
    difference = x.chamber_pressure_a - x.chamber_pressure_b
    losses = {
        "friction": c.friction.force(x.rod_velocity) * x.rod_velocity,
        "end_stops": -c.stops.damping_force(position, x.rod_velocity) * x.rod_velocity,
        "pump_friction": p.pump_viscous_torque * x.shaft_speed**2,
        "pump_compression": c.pump.compression_loss(
            c.oil, x.shaft_speed, x.chamber_pressure_a, x.chamber_pressure_b
        ),
        "internal_leakage": p.oil_density * p.internal_leakage * difference * (h_a - h_b),
    }
    for name, line, h in (("a", line_a, h_a), ("b", line_b, h_b)):
        drop = p.oil_density * (h_r - h)
        losses[f"make_up_{name}"] = line.make_up * drop
        losses[f"pilot_{name}"] = line.pilot * drop
        losses[f"relief_{name}"] = -line.relief * drop
        losses[f"leakage_{name}"] = -line.leakage * drop
    return losses


def _pressure_rate(
    oil: Oil, pressure: Expression, volume: Expression, inflow: Expression, growth: Expression
) -> Expression:
    """dp/dt of a chamber with mass flow `inflow` (kg/s) and volume rate `growth` (m³/s)."""
    by_mass = oil.stiffness_by_density(pressure) * inflow
    return (by_mass - oil.effective_bulk_modulus(pressure) * growth) / volume


def axis(
    x: SimpleNamespace, p: SimpleNamespace, speed_command: Expression, load_force: Expression
) -> Axis:
    """Equations of one axis.

    `speed_command` is normalised (1 is the rated speed) and limited to ±1; `load_force` (N) acts
    against extension.
    """
    c = _components(p)
    pressure_a, pressure_b, velocity = x.chamber_pressure_a, x.chamber_pressure_b, x.rod_velocity
    position = p.stroke / 2 + x.rod_displacement
    volume_a = p.dead_volume_a + c.area_a * position
    volume_b = p.dead_volume_b + c.area_b * (p.stroke - position)
    line_a = _line(p, pressure_a, pressure_b)
    line_b = _line(p, pressure_b, pressure_a)
    pumped = c.pump.mass_flow(c.oil, x.shaft_speed, pressure_a, pressure_b)
    crossing = pumped - p.oil_density * p.internal_leakage * (pressure_a - pressure_b)
    inflow_a = crossing + p.oil_density * line_a.inflow
    inflow_b = -crossing + p.oil_density * line_b.inflow
    reference = p.rated_speed * saturate(speed_command, COMMAND_WIDTH)
    torque_rate, integral_rate = c.drive.derivatives(
        reference, x.shaft_speed, x.air_gap_torque, x.speed_integral
    )
    friction = c.friction.force(velocity)
    pressure_force = (pressure_a - p.atmospheric_pressure) * c.area_a - (
        pressure_b - p.atmospheric_pressure
    ) * c.area_b
    stop_elastic = c.stops.elastic_force(position)
    stop_force = stop_elastic + c.stops.damping_force(position, velocity)
    shaft_torque = x.air_gap_torque - c.pump.torque(x.shaft_speed, pressure_a, pressure_b)
    rates = {
        "shaft_speed": shaft_torque / p.rotor_inertia,
        "air_gap_torque": torque_rate,
        "speed_integral": integral_rate,
        "chamber_pressure_a": _pressure_rate(
            c.oil, pressure_a, volume_a, inflow_a, c.area_a * velocity
        ),
        "chamber_pressure_b": _pressure_rate(
            c.oil, pressure_b, volume_b, inflow_b, -c.area_b * velocity
        ),
        "rod_displacement": velocity,
        "rod_velocity": (pressure_force - friction + stop_force - load_force) / p.load_mass,
    }
    reservoir_flow = p.oil_density * (line_a.inflow + line_b.inflow)
    kinetic = (p.rotor_inertia * x.shaft_speed**2 + p.load_mass * velocity**2) / 2
    stored = (
        kinetic
        + c.oil.stored_energy(pressure_a, volume_a)
        + c.oil.stored_energy(pressure_b, volume_b)
        + c.stops.stored_energy(position)
    )
    mass = c.oil.density_at(pressure_a) * volume_a + c.oil.density_at(pressure_b) * volume_b
    rise = c.oil.enthalpy(pressure_a) - c.oil.enthalpy(pressure_b)
    return Axis(
        rates=rates,
        position=position,
        line_a=line_a,
        line_b=line_b,
        pump_mass_flow=pumped,
        hydraulic_power=pumped * rise,
        reservoir_mass_flow=reservoir_flow,
        reservoir_power=reservoir_flow * c.oil.enthalpy(p.reservoir_pressure),
        fluid_mass=mass,
        stored_energy=stored,
        losses=_losses(x, p, c, line_a, line_b),
        friction_force=friction,
        pressure_force=pressure_force,
    )
