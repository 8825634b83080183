"""A plant as CasADi functions, its equilibria and its linear model about one of them.

A = ∂f/∂x,  B = ∂f/∂u,  C = ∂h/∂x,  D = ∂h/∂u        by exact derivatives.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from fmus.declaration import Parameter, State, Variable
from fmus.plant import Plant

Array = NDArray[np.float64]


class EquilibriumError(Exception):
    """No equilibrium was found."""


@dataclass(frozen=True)
class WorkingPoint:
    """Where a plant is usually linearised: held `inputs`, and the `output` brought to `target`
    by the first input. `description` says it in words."""

    description: str
    inputs: tuple[float, ...]
    output: str
    target: float


@dataclass(frozen=True)
class LinearModel:
    """A, B, C, D about (x, u), all in SI units, shapes (n, n), (n, m), (q, n), (q, m)."""

    x: Array
    u: Array
    A: Array
    B: Array
    C: Array
    D: Array

    def eigenvalues(self) -> NDArray[np.complex128]:
        """Eigenvalues of A in 1/s, slowest first."""
        values = np.linalg.eigvals(self.A).astype(np.complex128)
        return values[np.lexsort((values.imag, np.round(np.abs(values), 9)))]


def plant_functions(plant: Plant) -> tuple[Any, Any]:
    """CasADi functions f(x, u, p) and h(x, u, p) of vectors, in the plant's order."""
    groups: tuple[Sequence[State | Variable | Parameter], ...]
    groups = (plant.states, plant.inputs, plant.parameters)
    x, u, p = ({v.name: ca.SX.sym(v.name) for v in variables} for variables in groups)
    rates, outputs = plant.equations(
        SimpleNamespace(**x), SimpleNamespace(**u), SimpleNamespace(**p)
    )
    arguments = [ca.vertcat(*symbols.values()) for symbols in (x, u, p)]
    f = ca.vertcat(*[rates[v.name] for v in plant.states])
    h = ca.vertcat(*[outputs[v.name] for v in plant.outputs])
    return ca.Function("f", arguments, [f]), ca.Function("h", arguments, [h])


def parameter_values(plant: Plant, changed: Mapping[str, float] | None = None) -> Array:
    """Parameter vector of a plant, with some values changed by name."""
    changed = changed or {}
    unknown = sorted(set(changed) - {q.name for q in plant.parameters})
    if unknown:
        raise KeyError(f"{plant.name} has no parameters {unknown}")
    return np.array([changed.get(q.name, q.value) for q in plant.parameters])


def equilibrium(
    plant: Plant, u: Sequence[float], output: str, target: float, free_input: int = 0
) -> tuple[Array, Array]:
    """(x, u) at rest where `output` is `target`; input number `free_input` is solved for.

    The free input integrates the output's error, du/dt = 0.02 (target − y)/y_nominal, and linearly
    implicit Euler with growing steps follows that loop from the start state to rest, so that the
    way there is physical; its last steps are Newton's. Raises `EquilibriumError` when they do not
    converge to 1e-10 of the nominals, so also when y falls as the input rises.
    """
    f, h = plant_functions(plant)
    p = parameter_values(plant)
    number = [v.name for v in plant.outputs].index(output)
    state, inputs = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs))
    error = 0.02 * (target - h(state, inputs, p)[number]) / plant.outputs[number].nominal
    rate = ca.vertcat(f(state, inputs, p), error)
    slope = ca.jacobian(rate, ca.vertcat(state, inputs[free_input]))
    closed_loop = ca.Function("closed_loop", [state, inputs], [rate, slope])
    z = np.array([*(s.start for s in plant.states), u[free_input]])
    scale = np.array([*(s.nominal for s in plant.states), 1.0])
    trial = np.array(u, dtype=float)
    for time_step in np.geomspace(1e-4, 1e12, 400):
        trial[free_input] = z[-1]
        value, matrix = closed_loop(z[:-1], trial)
        change = np.linalg.solve(np.eye(z.size) / time_step - matrix.full(), value.full().ravel())
        z = z + change
        if time_step > 1e6 and np.max(np.abs(change / scale)) < 1e-10:
            trial[free_input] = z[-1]
            return z[:-1], trial
    raise EquilibriumError(
        f"{plant.name}: no rest with {output} = {target}; choose a target that it can hold"
    )


def linearize(plant: Plant, x: Array, u: Array) -> LinearModel:
    """Linear model about (x, u) with the default parameters."""
    f, h = plant_functions(plant)
    state, inputs = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs))
    p = parameter_values(plant)
    rate, output = f(state, inputs, p), h(state, inputs, p)
    matrices = ca.Function(
        "matrices",
        [state, inputs],
        [ca.jacobian(y, z) for y in (rate, output) for z in (state, inputs)],
    )
    A, B, C, D = (np.array(matrix.full()) for matrix in matrices(x, u))
    return LinearModel(x=x, u=u, A=A, B=B, C=C, D=D)
