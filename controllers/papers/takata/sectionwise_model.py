"""The model that `augmented_choosing` works with, to look at: (5) and (7) of Takata et al.

At the given states, without control:

    f(x),   A_i·x + w_i for each section,   Σ_i I_i(C(x))·(A_i·x + w_i)

The last is the sectionwise linear model, united by the choosing functions; what it lacks to f(x)
is the error ε of (7). Nothing is fed back: the block shows what a design believes.

Block arrays: p = [n, sections, L, N | weights of C (L·n) | sides | (A_i, w_i) | model's], and
x = [c (L) | I (sections) | f (n) | u (r) = 0].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from controllers.core.bind import bind
from controllers.core.block import Array, Block, Signal
from controllers.core.layout import Layout, part, row_of
from controllers.kalman.transition import model_rate
from controllers.papers.takata.augmented_choosing import AugmentedChoosing, separative_variables
from controllers.papers.takata.choosing import choose
from controllers.state_space.affine_model import affine, find_model

# Parameters: `HEAD`, then `TABLES`; a row of `linear` is A, then w, of one section.
TABLES = Layout.of(
    separative="separative", sides=("sections", "variables", 2), linear=("sections", "linear"),
    model="model",
)  # fmt: skip
STATE = Layout.of(c="variables", weights="sections", rate="states", inputs="inputs")
HEAD = Layout.of(
    n=(), sections=(), variables=(), sharpness=(), in_parameters=TABLES.entries,
    in_state=STATE.entries,
)  # fmt: skip
P_N, P_SECTIONS, P_VARIABLES, P_SHARPNESS, P_IN_PARAMETERS, P_IN_STATE = HEAD.places()
SEPARATIVE, SIDES, LINEAR, MODEL = map(TABLES.number, TABLES.names)
C, WEIGHTS, RATE, INPUTS = map(STATE.number, STATE.names)


def sectionwise_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `SectionwiseModel`."""
    n = int(p[P_N])
    sections = int(p[P_SECTIONS])
    in_p = p[P_IN_PARAMETERS:]
    in_x = p[P_IN_STATE:]
    c = part(in_x, x, C)
    weights = part(in_x, x, WEIGHTS)
    rate = part(in_x, x, RATE)
    separative_variables(part(in_p, p, SEPARATIVE), u, c)
    choose(sections, int(p[P_VARIABLES]), p[P_SHARPNESS], part(in_p, p, SIDES), c, weights)
    model_rate(part(in_p, p, MODEL), u, part(in_x, x, INPUTS), rate)
    for i in range(n):
        y[i] = rate[i]
        y[n + i] = 0.0
    for s in range(sections):
        linear = row_of(part(in_p, p, LINEAR), s, sections)
        for i in range(n):
            total = linear[n * n + i]
            for k in range(n):
                total = total + linear[i * n + k] * u[k]
            y[2 * n + s * n + i] = total
            y[n + i] = y[n + i] + weights[s] * total


@dataclass(frozen=True, kw_only=True)
class SectionwiseModel(AugmentedChoosing):
    """The sectionwise linear model of an `AugmentedChoosing` with the same fields.

    Its inputs are the states. Its outputs are `rate_…` of each state by the model, `united_…` by
    the united linear models, and `section_0_…`, `section_1_…`, … by each of them alone.
    """

    def outputs(self) -> tuple[Signal, ...]:
        """Rates of the model, of the united sections and of each section."""
        states = self._model().states
        kinds = [("rate", "f"), ("united", "Σ I_i·(A_i·x + w_i)")]
        kinds += [(f"section_{i}", f"A_{i}·x + w_{i}") for i in range(len(self.points))]
        return tuple(
            Signal(f"{kind}_{s.name}", f"({s.unit})/s", f"rate of change by {text}")
            for kind, text in kinds
            for s in states
        )

    def block(self, sample_time: float) -> Block:
        """The block; it has no memory, so the sample time does not enter."""
        model, functions = find_model(self.model, self.model_parameters), self.functions()
        n, separative = len(model.states), np.ravel(self.separative)
        sizes = {
            "separative": len(separative), "sections": functions.sections,
            "variables": functions.variables, "linear": n * n + n, "states": n,
            "inputs": len(model.inputs), "model": len(model.parameters),
        }  # fmt: skip
        head: dict[str, ArrayLike] = {
            "n": n, "sections": functions.sections, "variables": functions.variables,
            "sharpness": self.sharpness, "in_parameters": TABLES.table(HEAD.length, **sizes),
            "in_state": STATE.table(**sizes),
        }  # fmt: skip
        linear = [affine(model, point) for point in self.points]
        tables: dict[str, ArrayLike] = {
            "separative": separative, "sides": functions.sides(), "model": model.parameters,
            "linear": [np.concatenate([about.A.ravel(), about.w]) for about in linear],
        }  # fmt: skip
        variables: Callable[[Array, Array, Array], None] = self.separative_function
        return Block(
            inputs=model.states,
            outputs=self.outputs(),
            step=bind(sectionwise_step, separative_variables=variables, model_rate=model.rate),
            parameters=np.concatenate([HEAD.fill(head), TABLES.fill(tables, **sizes)]),
            state=STATE.fill({}, **sizes),
        )
