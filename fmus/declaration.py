"""What a plant is, before any FMU exists: variables, parameters and one function of equations.

    dx/dt = f(x, u, p)        y = h(x, u, p)

The equations are written once, over CasADi symbols; native FMU, portable FMU, Jacobians and the
README table are made from them. A plant is time-invariant, smooth in what the solver sees, and
has no events. This module refuses to know how an FMU is made (`fmus.packaging`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

Equations = Callable[
    [SimpleNamespace, SimpleNamespace, SimpleNamespace], tuple[Mapping[str, Any], Mapping[str, Any]]
]


@dataclass(frozen=True)
class Variable:
    """An input or output: `unit` in SI, `nominal` its order of magnitude, `start` for inputs."""

    name: str
    unit: str
    description: str
    start: float = 0.0
    nominal: float = 1.0


@dataclass(frozen=True)
class State:
    """A continuous state: `start` is its default initial value, `nominal` scales its tolerance."""

    name: str
    unit: str
    description: str
    start: float
    nominal: float


@dataclass(frozen=True)
class Parameter:
    """A parameter: `source` says where the value comes from (table of the paper, or our choice
    with its reason); `minimum` and `maximum` bound what a user may set; `tunable` ones may change
    during a run."""

    name: str
    unit: str
    description: str
    value: float
    source: str
    minimum: float | None = None
    maximum: float | None = None
    tunable: bool = True


@dataclass(frozen=True)
class DisplayUnit:
    """How people read a unit: display = factor * SI + offset, e.g. ("Pa", "bar", 1e-5)."""

    unit: str
    name: str
    factor: float
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class PlantModel:
    """A plant as data.

    `equations(x, u, p)` gets namespaces of CasADi SX scalars, one attribute a state, input and
    parameter, and returns two mappings: derivative by state name, value by output name.
    `step_size` is the communication step (s) proposed to importing tools.
    """

    name: str
    description: str
    states: tuple[State, ...]
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    parameters: tuple[Parameter, ...]
    equations: Equations
    step_size: float = 0.01
    stop_time: float = 1.0
    display_units: tuple[DisplayUnit, ...] = ()
    version: str = "1.0"
