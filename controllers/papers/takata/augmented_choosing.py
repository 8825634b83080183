"""Augmented automatic choosing control (AACC) of Takata et al., for any model f(x) + g(x)·u.

The state space is divided into sections by `choosing.ChoosingFunctions`, in separative variables
c = C(x). In section i the model is linearised about χ_i, f(x) ≈ A_i·x + w_i, and the constant w_i
is taken for the coefficient of one more state that decays slowly from 1, (4) and (5):

    dX/dt = Ā_i·X + B̄_i·u,   X = (x, x_{n+1}),   Ā_i = [A_i w_i; 0 −σ],   B̄_i = [B_i; 0]

An LQ design a section gives u_i = −F_i·X (9), and the choosing functions unite them (6):

    u = Σ_i I_i(C(x))·u_i

With estimates for x this is the paper's AACCF; with the true states it is its full-state form.
x_{n+1}(t_k) = x_{n+1}(0)·exp(−σ·t_k) is exact at the samples. With one section at rest w = 0, and
the controller is `lq_regulator.LQRegulator`.

Block arrays: p = [head | weights of C (L·n) | sides | F_i (r·(n+1) each)],
x = [x_{n+1} | c (L) | I (sections)].
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from controllers.core.bind import bind
from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require, require_finite, require_positive
from controllers.core.layout import Layout, part, row_of
from controllers.core.limit import limit
from controllers.kalman.estimator import Model
from controllers.papers.takata.choosing import ChoosingFunctions, choose
from controllers.state_space.affine_model import affine, find_model, require_rest
from controllers.state_space.lq import LQDesign, continuous_lq
from controllers.state_space.lq_regulator import control_signals
from controllers.state_space.state_weights import Weights, weight_matrix

# Parameters: `HEAD`, then `TABLES`; a row of gains is that of one control of one section.
TABLES = Layout.of(
    separative="separative", sides=("sections", "variables", 2),
    gains=("sections", "inputs", "augmented"),
)  # fmt: skip
STATE = Layout.of(extra=(), c="variables", weights="sections")
HEAD = Layout.of(
    n=(), r=(), sections=(), variables=(), sharpness=(), decay=(), u_min=(), u_max=(),
    in_parameters=TABLES.entries, in_state=STATE.entries,
)  # fmt: skip
(P_N, P_R, P_SECTIONS, P_VARIABLES, P_SHARPNESS, P_DECAY, P_U_MIN, P_U_MAX, P_IN_PARAMETERS,
 P_IN_STATE) = HEAD.places()  # fmt: skip
SEPARATIVE, SIDES, GAINS = map(TABLES.number, TABLES.names)
X_EXTRA, C, WEIGHTS = map(STATE.number, STATE.names)

Corners = tuple[tuple[float, ...], ...]


def linear_variables(weights: Array, x: Array, c: Array) -> None:
    """c = W·x: separative variables that are linear combinations of the states."""
    n = x.shape[0]
    for j in range(c.shape[0]):
        total = 0.0
        for i in range(n):
            total = total + weights[j * n + i] * x[i]
        c[j] = total


def separative_variables(weights: Array, x: Array, c: Array) -> None:
    """Placeholder: C(x) into c (L,); bound by `bind`."""


def section_control(n: int, F: Array, x: Array, extra: float) -> float:
    """−F·X for one control; F (n+1,)."""
    total = -F[n] * extra
    for i in range(n):
        total = total - F[i] * x[i]
    return float(total)


def choosing_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `AugmentedChoosing`: the states in, controls and internals out."""
    n = int(p[P_N])
    r = int(p[P_R])
    sections = int(p[P_SECTIONS])
    variables = int(p[P_VARIABLES])
    c = part(p[P_IN_STATE:], x, C)
    weights = part(p[P_IN_STATE:], x, WEIGHTS)
    gains = part(p[P_IN_PARAMETERS:], p, GAINS)
    separative_variables(part(p[P_IN_PARAMETERS:], p, SEPARATIVE), u, c)
    sides = part(p[P_IN_PARAMETERS:], p, SIDES)
    choose(sections, variables, p[P_SHARPNESS], sides, c, weights)
    for j in range(r):
        total = 0.0
        for i in range(sections):
            F = row_of(gains, i * r + j, sections * r)
            control = section_control(n, F, u, x[X_EXTRA])
            y[r + 1 + sections + i * r + j] = control
            total = total + weights[i] * control
        y[j] = limit(total, p[P_U_MIN], p[P_U_MAX])
    y[r] = x[X_EXTRA]
    for i in range(sections):
        y[r + 1 + i] = weights[i]
    x[X_EXTRA] = x[X_EXTRA] * p[P_DECAY]


@dataclass(frozen=True, kw_only=True)
class AugmentedChoosing:
    """Augmented automatic choosing control.

    model            a model, or "package.module:Class"; `model_parameters` go to that class
    points           χ_i, where each section is linearised; χ_0 = 0, at rest
    lower, upper     corners of the sections in the separative variables; they tile the space
    sharpness        N of (3)
    separative       W (L rows of n): c = W·x, or what `separative_function` makes of it
    Q, R             weights of X (n + 1) and of the inputs: diagonals or matrices
    sigma            σ of (4) [1/s];  extra_start  x_{n+1}(0)
    u_min, u_max     limits of every control

    Its inputs are the states of the model, by their names.
    """

    model: str | Model
    model_parameters: Mapping[str, Any] = field(default_factory=dict)
    points: Corners
    lower: Corners
    upper: Corners
    sharpness: float
    separative: Corners
    separative_function: Callable[[Array, Array, Array], None] = linear_variables
    Q: Weights
    R: Weights
    sigma: float
    extra_start: float = 1.0
    u_min: float = -math.inf
    u_max: float = math.inf

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        name = type(self).__name__
        require_positive(f"{name}.sigma", self.sigma)
        require_finite(f"{name}.extra_start", self.extra_start)
        require(self.u_min < self.u_max, f"{name}.u_min, u_max", "u_min below",
                (self.u_min, self.u_max))  # fmt: skip
        model, functions = self._model(), self.functions()
        n, L = len(model.states), functions.variables
        require(len(self.points) == functions.sections, f"{name}.points",
                f"one for each of {functions.sections} sections", self.points)  # fmt: skip
        rows = tuple(len(row) for row in self.separative)
        require(rows == (n,) * L, f"{name}.separative", f"{L} rows of {n} numbers", self.separative)
        for i, point in enumerate(self.points):
            require(len(point) == n, f"{name}.points", f"{n} numbers each", point)
            held = functions.sections_at(self._variables(point).tolist())
            require(i in held, f"{name}.points: χ_{i}", f"a point in section {i}", point)
        require(not any(self.points[0]), f"{name}.points: χ_0", "the rest, 0", self.points[0])
        require_rest(model)
        _ = self.designs  # faults of the weights are found here

    def functions(self) -> ChoosingFunctions:
        """The choosing functions of the sections."""
        return ChoosingFunctions(self.lower, self.upper, self.sharpness)

    @cached_property
    def designs(self) -> tuple[LQDesign, ...]:
        """The LQ design of each section, on the augmented system (8)."""
        model, designs = self._model(), []
        n, r = len(model.states), len(model.inputs)
        Q = weight_matrix(f"{type(self).__name__}.Q", self.Q, n + 1)
        R = weight_matrix(f"{type(self).__name__}.R", self.R, r)
        for point in self.points:
            about = affine(model, point)
            A = np.zeros((n + 1, n + 1))
            A[:n, :n], A[:n, n], A[n, n] = about.A, about.w, -self.sigma
            designs.append(continuous_lq(A, np.vstack([about.B, np.zeros((1, r))]), Q, R))
        return tuple(designs)

    def outputs(self) -> tuple[Signal, ...]:
        """Controls, x_{n+1}, the weights I_i, and the controls of the sections."""
        controls = control_signals(self._model())
        sections = range(len(self.points))
        return (
            *controls,
            Signal("extra_state", "1", "x_{n+1} of (4)", self.extra_start),
            *(Signal(f"weight_{i}", "1", f"choosing function of section {i}") for i in sections),
            *(
                Signal(f"{s.name}_section_{i}", s.unit, f"control of section {i}, (9)")
                for i in sections
                for s in controls
            ),
        )

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        require_positive(f"{type(self).__name__}.block: sample_time", sample_time)
        model, functions = self._model(), self.functions()
        separative = np.ravel(self.separative)
        sizes = {
            "separative": len(separative), "sections": functions.sections,
            "variables": functions.variables, "inputs": len(model.inputs),
            "augmented": len(model.states) + 1,
        }  # fmt: skip
        head: dict[str, ArrayLike] = {
            "n": len(model.states), "r": len(model.inputs), "sections": functions.sections,
            "variables": functions.variables, "sharpness": self.sharpness,
            "decay": math.exp(-self.sigma * sample_time), "u_min": self.u_min,
            "u_max": self.u_max, "in_parameters": TABLES.table(HEAD.length, **sizes),
            "in_state": STATE.table(**sizes),
        }  # fmt: skip
        tables: dict[str, ArrayLike] = {
            "separative": separative, "sides": functions.sides(),
            "gains": [design.K for design in self.designs],
        }  # fmt: skip
        return Block(
            inputs=model.states,
            outputs=self.outputs(),
            step=bind(choosing_step, separative_variables=self.separative_function),
            parameters=np.concatenate([HEAD.fill(head), TABLES.fill(tables, **sizes)]),
            state=STATE.fill({"extra": self.extra_start}, **sizes),
        )

    def _model(self) -> Model:
        return find_model(self.model, self.model_parameters)

    def _variables(self, point: tuple[float, ...]) -> Array:
        c = np.empty(len(self.separative))
        self.separative_function(np.ravel(self.separative).astype(float), np.array(point), c)
        return c
