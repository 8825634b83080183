"""The electro-hydraulic servo: a valve-controlled cylinder that moves a mass against a spring.

Raheem 2013, (1)–(5). States x₁…x₄: position, speed, load pressure, spool position.

    dx₁/dt = x₂
    dx₂/dt = (−k x₁ − F x₂ + A x₃ − F_L)/m                                    (1)
    dx₃/dt = (4β/V)(Q_L − A x₂ − C_tp x₃)                                     (2)
    Q_L    = C_d w x₄ √((P_s − sgn(x₄) x₃)/ρ)                                 (3)
    dx₄/dt = (K (i + Δi) − x₄)/τ_v                                            (5)

sgn(x₄) is x₄/√(x₄² + δ²), and √z is `signed_root`, which lets the flow turn back where the load
pressure exceeds the supply pressure. Process noise comes in through Δi and F_L.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace

import casadi as ca

from fmus.declaration import DisplayUnit, Parameter, State, Variable
from fmus.linearization import WorkingPoint
from fmus.physics.smooth import Expression, signed_root
from fmus.plant import Plant

TABLE_1 = "Raheem 2013, Table 1"
RIG = "our choice: the test rig of Alleyne and Yao, whose other values Table 1 repeats"

STATES = (
    State("position", "m", "load displacement, 0 where the spring is unloaded", 0.0, 0.01),
    State("velocity", "m/s", "load speed", 0.0, 0.01),
    State("load_pressure", "Pa", "pressure difference across the piston", 0.0, 1e6),
    State("spool_position", "m", "spool displacement of the servo valve", 0.0, 1e-6),
)

INPUTS = (
    Variable("current", "A", "commanded valve current", nominal=1e-3),
    Variable("current_error", "A", "Δi: current that the command does not know of", nominal=1e-3),
    Variable("load_force", "N", "F_L: outside force against positive motion", nominal=100.0),
)

OUTPUTS = (
    *(Variable(s.name, s.unit, s.description, nominal=s.nominal) for s in STATES),
    Variable("load_flow", "m3/s", "Q_L through the valve into the cylinder", nominal=1e-5),
    Variable("piston_force", "N", "A·P_L, positive in the direction of motion", nominal=1e3),
    Variable("stored_energy", "J", "in the mass, the spring and the oil", nominal=1.0),
    Variable("valve_power", "W", "Q_L·P_L: given by the valve to the cylinder", nominal=10.0),
    Variable("dissipated_power", "W", "lost in friction and leakage", nominal=1.0),
    Variable("load_power", "W", "given to the outside force", nominal=1.0),
)

# fmt: off
PARAMETERS = (
    Parameter("load_mass", "kg", "m: everything that moves", 24.0, TABLE_1, 0.1, 1e4),
    Parameter("spring_stiffness", "N/m", "k: elastic load", 16010.0, TABLE_1, 0.0, 1e8),
    Parameter("friction", "N.s/m", "F: viscous, of load and rod", 60.0, TABLE_1, 0.0, 1e6),
    Parameter("piston_area", "m2", "A: ram area", 3.2673e-4, RIG, 1e-6, 1.0),
    Parameter("total_volume", "m3", "V_t: cylinder and hoses", 6.535e-5, TABLE_1, 1e-7, 1.0),
    Parameter("bulk_modulus", "Pa", "β_e: effective", 1e9, TABLE_1, 1e6, 1e11),
    Parameter("leakage", "m3/(s.Pa)", "C_tp: total internal", 2e-12, TABLE_1, 0.0, 1e-6),
    Parameter("discharge_coefficient", "1", "C_d", 0.6, TABLE_1, 0.01, 1.0),
    Parameter("spool_gradient", "m", "w: valve area per spool displacement",
              0.022, TABLE_1, 1e-5, 1.0),
    Parameter("oil_density", "kg/m3", "ρ", 840.0, TABLE_1, 1.0, 1e4),
    Parameter("supply_pressure", "Pa", "P_s, above the return line", 10342500.0, RIG, 1e4, 1e9),
    Parameter("valve_time_constant", "s", "τ_v: spool's answer to the current",
              0.01, TABLE_1, 1e-5, 10.0),
    Parameter("valve_gain", "m/A", "K: spool displacement per current at rest", 4.5e-3,
              "our choice: the printed k_v of 0.45e-8 moves nothing; 1 mA brings 0.27 of P_s",
              0.0, 10.0),
    Parameter("spool_sign_width", "m", "δ: spool displacement over which sgn turns", 1e-7,
              "our choice: 2 % of the spool's travel under 1 mA; a real spool leaks there",
              1e-10, 1e-3),
    Parameter("orifice_root_width", "Pa", "pressure difference below which the root is linear",
              1e4, "our choice: 0.1 bar, laminar flow; 5e-7 of the flow at half of P_s",
              1.0, 1e7),
)
# fmt: on


def equations(
    x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
) -> tuple[Mapping[str, Expression], Mapping[str, Expression]]:
    """dx/dt by state and y by output, over CasADi scalars."""
    sign = x.spool_position / ca.sqrt(x.spool_position**2 + p.spool_sign_width**2)
    drop = p.supply_pressure - sign * x.load_pressure
    root = signed_root(drop, p.orifice_root_width) / ca.sqrt(p.oil_density)
    flow = p.discharge_coefficient * p.spool_gradient * x.spool_position * root
    force = p.piston_area * x.load_pressure
    spring = p.spring_stiffness * x.position
    leakage = p.leakage * x.load_pressure
    stiffness = 4 * p.bulk_modulus / p.total_volume
    rates = {
        "position": x.velocity,
        "velocity": (force - spring - p.friction * x.velocity - u.load_force) / p.load_mass,
        "load_pressure": stiffness * (flow - p.piston_area * x.velocity - leakage),
        "spool_position": (p.valve_gain * (u.current + u.current_error) - x.spool_position)
        / p.valve_time_constant,
    }
    kinetic = p.load_mass * x.velocity**2 / 2
    outputs = {
        **{state.name: getattr(x, state.name) for state in STATES},
        "load_flow": flow,
        "piston_force": force,
        "stored_energy": kinetic + spring * x.position / 2 + x.load_pressure**2 / (2 * stiffness),
        "valve_power": flow * x.load_pressure,
        "dissipated_power": p.friction * x.velocity**2 + leakage * x.load_pressure,
        "load_power": u.load_force * x.velocity,
    }
    return rates, outputs


plant = Plant(
    name="electro_hydraulic_servo",
    description="Valve-controlled cylinder with mass and spring (Raheem 2013)",
    states=STATES,
    inputs=INPUTS,
    outputs=OUTPUTS,
    parameters=PARAMETERS,
    equations=equations,
    step_size=1e-4,
    stop_time=4.0,
    display_units=(
        DisplayUnit("Pa", "bar", 1e-5),
        DisplayUnit("m", "mm", 1e3),
        DisplayUnit("A", "mA", 1e3),
        DisplayUnit("m3/s", "l/min", 6e4),
    ),
)

WORKING_POINTS = (
    WorkingPoint("at rest, valve closed", (0.0, 0.0, 0.0), "position", 0.0),
    WorkingPoint("holding 6 mm", (0.0, 0.0, 0.0), "position", 0.006),
    WorkingPoint("holding 50 mm", (0.0, 0.0, 0.0), "position", 0.050),
)
