"""The right half of a two-mass oscillator, with the spring that couples it to the left half.

    dx/dt = v
    m dv/dt = -F - c x - d v,   F = c_k (x - x_l) + d_k (v - v_l)

x_l and v_l come from `oscillator_left`, which F pulls to the right. F depends directly on both.
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
    State("position", "m", "x, displacement of the right mass to the right", 0.0, 0.1),
    State("velocity", "m/s", "v, velocity of the right mass", 0.0, 1.0),
)

INPUTS = (
    Variable("left_position", "m", "x_l, displacement of the left mass", nominal=0.1),
    Variable("left_velocity", "m/s", "v_l, velocity of the left mass"),
)

OUTPUTS = (
    Variable("coupling_force", "N", "F, pulls the left mass to the right", nominal=10.0),
    Variable("position", "m", "x, displacement of the right mass", nominal=0.1),
    Variable("velocity", "m/s", "v, velocity of the right mass"),
)

PARAMETERS = (
    Parameter("mass", "kg", "m", 1.0, OURS, 1e-3, 1e3),
    Parameter("stiffness", "N/m", "c, spring to the right wall", 100.0, OURS, 0.0, 1e6),
    Parameter("damping", "N.s/m", "d, damper to the right wall", 1.0,
              "our choice: damping ratio 0.05", 0.0, 1e4),
    Parameter("coupling_stiffness", "N/m", "c_k, spring between the masses", 50.0,
              "our choice: beats are seen within a second", 0.0, 1e6),
    Parameter("coupling_damping", "N.s/m", "d_k, damper between the masses", 0.5,
              "our choice: the force depends on the velocities too", 0.0, 1e4),
)  # fmt: skip


def equations(
    x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
) -> tuple[Mapping[str, Expression], Mapping[str, Expression]]:
    """dx/dt by state and y by output, over CasADi scalars."""
    stretch, rate = x.position - u.left_position, x.velocity - u.left_velocity
    pull = p.coupling_stiffness * stretch + p.coupling_damping * rate
    force = -pull - p.stiffness * x.position - p.damping * x.velocity
    rates = {"position": x.velocity, "velocity": force / p.mass}
    outputs = {
        "coupling_force": pull,
        "position": x.position,
        "velocity": x.velocity,
    }
    return rates, outputs


plant = Plant(
    name="oscillator_right",
    description="Right half of a two-mass oscillator: motion in, force out",
    states=STATES,
    inputs=INPUTS,
    outputs=OUTPUTS,
    parameters=PARAMETERS,
    equations=equations,
    step_size=0.01,
    stop_time=2.0,
)

WORKING_POINTS = (WorkingPoint("at rest", (0.0, 0.0), "coupling_force", 0.0),)
