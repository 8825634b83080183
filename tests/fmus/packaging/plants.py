"""Plants with known answers, made for the tests of the packaging."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import casadi as ca

from fmus.declaration import DisplayUnit, Parameter, State, Variable
from fmus.plant import Plant

Result = tuple[dict[str, Any], dict[str, Any]]


def _oscillator(x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Result:
    acceleration = (u.force - p.damping * x.velocity - p.stiffness * x.position) / p.mass
    return (
        {"position": x.velocity, "velocity": acceleration},
        {
            "position": x.position,
            "spring_force": p.stiffness * x.position,
            "acceleration": acceleration,
        },
    )


oscillator = Plant(
    name="oscillator",
    description="Damped linear oscillator <with feedthrough & markup>",
    states=(
        State("position", "m", "Displacement", 0.1, 0.1),
        State("velocity", "m/s", "Speed", 0.0, 1.0),
    ),
    inputs=(Variable("force", "N", "Force on the mass", 0.0, 10.0),),
    outputs=(
        Variable("position", "m", "Displacement", nominal=0.1),
        Variable("spring_force", "N", "Force in the spring", nominal=10.0),
        Variable("acceleration", "m/s2", "Acceleration", nominal=10.0),
    ),
    parameters=(
        Parameter("mass", "kg", "Mass", 2.0, "test", 0.1, 100.0, tunable=False),
        Parameter("damping", "N.s/m", "Damping", 1.5, "test", 0.0),
        Parameter("stiffness", "N/m", "Stiffness", 80.0, "test", 0.0, 1e4),
    ),
    equations=_oscillator,
    display_units=(DisplayUnit("m", "mm", 1e3),),
)


def _van_der_pol(x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Result:
    return (
        {"x0": x.x1, "x1": p.mu * (1 - x.x0**2) * x.x1 - x.x0},
        {"y0": x.x0, "y1": x.x1},
    )


van_der_pol = Plant(
    name="van_der_pol",
    description="Van der Pol's oscillator, no inputs",
    states=(State("x0", "1", "first", 2.0, 1.0), State("x1", "1", "second", 0.0, 1.0)),
    inputs=(),
    outputs=(Variable("y0", "1", "first"), Variable("y1", "1", "second")),
    parameters=(Parameter("mu", "1", "damping", 5.0, "test", 0.0, 1000.0),),
    equations=_van_der_pol,
    stop_time=10.0,
)


def _static(x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Result:
    return {}, {"product": p.gain * u.a * u.b, "sum": u.a + u.b}


static_gain = Plant(
    name="static_gain",
    description="No states: outputs follow inputs at once",
    states=(),
    inputs=(Variable("a", "1", "first", 2.0), Variable("b", "1", "second", 3.0)),
    outputs=(Variable("product", "1", "gain a b"), Variable("sum", "1", "a + b")),
    parameters=(Parameter("gain", "1", "gain", 1.5, "test"),),
    equations=_static,
)


def _escape(x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Result:
    return {"x": x.x**2}, {"y": x.x}


finite_escape = Plant(
    name="finite_escape",
    description="x' = x^2 from x(0) = 1 is 1/(1 - t): it escapes at t = 1",
    states=(State("x", "1", "escapes", 1.0, 1.0),),
    inputs=(),
    outputs=(Variable("y", "1", "x"),),
    parameters=(),
    equations=_escape,
)


def _hydraulic(x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Result:
    """A servo pump fills the bore side of a cylinder that pushes a spring; stiff."""
    volume_a = p.dead_volume + p.area_a * x.position
    volume_b = p.dead_volume + p.area_b * (p.stroke - x.position)
    flow = p.displacement * x.speed / (2 * ca.pi)
    friction = p.friction * ca.tanh(x.velocity / 0.01) + p.viscous * x.velocity
    force = p.spring * x.position
    drive = p.area_a * x.pressure_a - p.area_b * x.pressure_b
    inflow_a = flow - p.leakage * x.pressure_a - p.area_a * x.velocity
    inflow_b = p.area_b * x.velocity - p.conductance * x.pressure_b
    return (
        {
            "position": x.velocity,
            "velocity": (drive - friction - force) / p.mass,
            "pressure_a": p.bulk / volume_a * inflow_a,
            "pressure_b": p.bulk / volume_b * inflow_b,
            "speed": (u.command - x.speed) / p.lag,
        },
        {"force": force, "flow": flow, "pressure_a": x.pressure_a},
    )


hydraulic = Plant(
    name="hydraulic",
    description="Five stiff states: pump, two chambers, mass and spring",
    states=(
        State("position", "m", "Rod", 0.02, 0.1),
        State("velocity", "m/s", "Rod speed", 0.0, 0.1),
        State("pressure_a", "Pa", "Bore side", 3.5e6, 1e6),
        State("pressure_b", "Pa", "Rod side", 1e5, 1e6),
        State("speed", "rad/s", "Pump speed", 0.0, 100.0),
    ),
    inputs=(Variable("command", "rad/s", "Pump speed command", 0.0, 100.0),),
    outputs=(
        Variable("force", "N", "Spring force", nominal=1e4),
        Variable("flow", "m3/s", "Pump flow", nominal=1e-4),
        Variable("pressure_a", "Pa", "Bore side", nominal=1e6),
    ),
    parameters=(
        Parameter("area_a", "m2", "Bore area", 3.1e-3, "test", 1e-5),
        Parameter("area_b", "m2", "Ring area", 2.1e-3, "test", 1e-5),
        Parameter("stroke", "m", "Stroke", 0.15, "test", 0.01),
        Parameter("dead_volume", "m3", "Dead volume", 1e-4, "test", 1e-6),
        Parameter("bulk", "Pa", "Bulk modulus", 1.5e9, "test", 1e7),
        Parameter("displacement", "m3", "Pump displacement a turn", 15e-6, "test", 0.0),
        Parameter("leakage", "m3/(s.Pa)", "Leakage", 2e-12, "test", 0.0),
        Parameter("conductance", "m3/(s.Pa)", "Return line", 1e-9, "test", 0.0),
        Parameter("spring", "N/m", "Spring", 519e3, "test", 0.0),
        Parameter("friction", "N", "Coulomb friction", 200.0, "test", 0.0),
        Parameter("viscous", "N.s/m", "Viscous friction", 2000.0, "test", 0.0),
        Parameter("mass", "kg", "Load", 1000.0, "test", 1.0),
        Parameter("lag", "s", "Motor lag", 0.02, "test", 1e-4),
    ),
    equations=_hydraulic,
    display_units=(DisplayUnit("Pa", "bar", 1e-5), DisplayUnit("rad/s", "rev/min", 9.5492966)),
)

ALL = (oscillator, van_der_pol, static_gain, finite_escape, hydraulic)
