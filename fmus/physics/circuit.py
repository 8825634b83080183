"""The closed circuit of an axis: pump between two lines, valves from each line to the reservoir.

    Σṁ_a =  ṁ_pump − ρ₀ C_i (p_a − p_b) + ρ₀ (Q_make-up + Q_pilot − Q_relief − Q_leak)_a
    Σṁ_b = −ṁ_pump + ρ₀ C_i (p_a − p_b) + ρ₀ (Q_make-up + Q_pilot − Q_relief − Q_leak)_b

Valve and leak flows are volumes at reference density ρ₀. Each line's pilot-operated valve is
piloted by the other line: under load the low line stays open to the reservoir, which takes up and
gives back the difference of the two piston areas.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

from fmus.physics.fluid import Oil
from fmus.physics.pump import Pump
from fmus.physics.smooth import Expression
from fmus.physics.valves import check_valve, pilot_check_valve, relief_valve

RATING_PRESSURE = 1e5  # Pa; valve sizes are given as the flow at this difference


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
class Circuit:
    """Flows of the circuit: `pumped` from B to A, `inflow_a` and `inflow_b` into the chambers,
    `reservoir` out of the reservoir, all in kg/s."""

    line_a: Line
    line_b: Line
    pumped: Expression
    inflow_a: Expression
    inflow_b: Expression
    reservoir: Expression


def circuit(x: SimpleNamespace, p: SimpleNamespace, oil: Oil, pump: Pump) -> Circuit:
    """All flows, from shaft speed and chamber pressures."""
    pressure_a, pressure_b = x.chamber_pressure_a, x.chamber_pressure_b
    line_a = _line(p, pressure_a, pressure_b)
    line_b = _line(p, pressure_b, pressure_a)
    pumped = pump.mass_flow(oil, x.shaft_speed, pressure_a, pressure_b)
    crossing = pumped - p.oil_density * p.internal_leakage * (pressure_a - pressure_b)
    return Circuit(
        line_a=line_a,
        line_b=line_b,
        pumped=pumped,
        inflow_a=crossing + p.oil_density * line_a.inflow,
        inflow_b=-crossing + p.oil_density * line_b.inflow,
        reservoir=p.oil_density * (line_a.inflow + line_b.inflow),
    )


def circuit_losses(
    x: SimpleNamespace, p: SimpleNamespace, oil: Oil, pump: Pump, flows: Circuit
) -> dict[str, Expression]:
    """Each dissipation of the circuit in W by name: mass flow times enthalpy drop, all ≥ 0."""
    pressure_a, pressure_b = x.chamber_pressure_a, x.chamber_pressure_b
    h_a, h_b = oil.enthalpy(pressure_a), oil.enthalpy(pressure_b)
    h_r = oil.enthalpy(p.reservoir_pressure)
    leak = p.oil_density * p.internal_leakage * (pressure_a - pressure_b)
    losses = {
        "pump_friction": pump.viscous_torque * x.shaft_speed**2,
        "pump_compression": pump.compression_loss(oil, x.shaft_speed, pressure_a, pressure_b),
        "internal_leakage": leak * (h_a - h_b),
    }
    for name, line, h in (("a", flows.line_a, h_a), ("b", flows.line_b, h_b)):
        drop = p.oil_density * (h_r - h)
        losses[f"make_up_{name}"] = line.make_up * drop
        losses[f"pilot_{name}"] = line.pilot * drop
        losses[f"relief_{name}"] = -line.relief * drop
        losses[f"leakage_{name}"] = -line.leakage * drop
    return losses


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
