"""The left half of a two-mass oscillator: a mass on a spring and a damper, pulled by a force.

    dx/dt = v
    m dv/dt = F - c x - d v

F is what the spring between the halves pulls with; it belongs to `oscillator_right`, which gives
it. Position and velocity do not depend on F directly, so the two halves form no algebraic loop.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace

from fmus.declaration import Parameter, State, Variable
from fmus.linearization import WorkingPoint
from fmus.physics.smooth import Expression
from fmus.plant import Plant

OURS = "our choice: round numbers, angular frequency 10 rad/s alone"

STATES = (
    State("position", "m", "x, displacement of the left mass to the right", 0.0, 0.1),
    State("velocity", "m/s", "v, velocity of the left mass", 0.0, 1.0),
)

INPUTS = (Variable("coupling_force", "N", "F, pulls the left mass to the right", nominal=10.0),)

OUTPUTS = (
    Variable("position", "m", "x, displacement of the left mass", nominal=0.1),
    Variable("velocity", "m/s", "v, velocity of the left mass"),
)

PARAMETERS = (
    Parameter("mass", "kg", "m", 1.0, OURS, 1e-3, 1e3),
    Parameter("stiffness", "N/m", "c, spring to the left wall", 100.0, OURS, 0.0, 1e6),
    Parameter("damping", "N.s/m", "d, damper to the left wall", 1.0,
              "our choice: damping ratio 0.05", 0.0, 1e4),
)  # fmt: skip


def equations(
    x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
) -> tuple[Mapping[str, Expression], Mapping[str, Expression]]:
    """dx/dt by state and y by output, over CasADi scalars."""
    force = u.coupling_force - p.stiffness * x.position - p.damping * x.velocity
    rates = {"position": x.velocity, "velocity": force / p.mass}
    return rates, {"position": x.position, "velocity": x.velocity}


plant = Plant(
    name="oscillator_left",
    description="Left half of a two-mass oscillator: force in, motion out",
    states=STATES,
    inputs=INPUTS,
    outputs=OUTPUTS,
    parameters=PARAMETERS,
    equations=equations,
    step_size=0.01,
    stop_time=2.0,
)

WORKING_POINTS = (WorkingPoint("at rest", (0.0,), "position", 0.0),)
