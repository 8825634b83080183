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

from controllers.core.bind import bind
from controllers.core.block import Array, Block, Signal
from controllers.kalman.transition import model_rate
from controllers.papers.takata.augmented_choosing import AugmentedChoosing, separative_variables
from controllers.papers.takata.choosing import choose
from controllers.state_space.affine_model import affine, find_model

P_N, P_SECTIONS, P_VARIABLES, P_SHARPNESS, P_C = range(5)


def sectionwise_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `SectionwiseModel`."""
    n = int(p[P_N])
    sections = int(p[P_SECTIONS])
    variables = int(p[P_VARIABLES])
    at_sides = P_C + variables * n
    at_linear = at_sides + 2 * sections * variables
    width = n * n + n
    c = x[:variables]
    weights = x[variables : variables + sections]
    rate = x[variables + sections : variables + sections + n]
    separative_variables(p[P_C:at_sides], u, c)
    choose(sections, variables, p[P_SHARPNESS], p[at_sides:at_linear], c, weights)
    model_rate(p[at_linear + sections * width :], u, x[variables + sections + n :], rate)
    for i in range(n):
        y[i] = rate[i]
        y[n + i] = 0.0
    for s in range(sections):
        at = at_linear + s * width
        for i in range(n):
            total = p[at + n * n + i]
            for k in range(n):
                total = total + p[at + i * n + k] * u[k]
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
        n, r = len(model.states), len(model.inputs)
        head = [n, functions.sections, functions.variables, self.sharpness]
        linear = [affine(model, point) for point in self.points]
        parts = [np.concatenate([about.A.ravel(), about.w]) for about in linear]
        variables: Callable[[Array, Array, Array], None] = self.separative_function
        return Block(
            inputs=model.states,
            outputs=self.outputs(),
            step=bind(sectionwise_step, separative_variables=variables, model_rate=model.rate),
            parameters=np.concatenate(
                [
                    head, np.ravel(self.separative).astype(float), functions.sides(), *parts,
                    model.parameters,
                ]
            ),
            state=np.zeros(functions.variables + functions.sections + n + r),
        )  # fmt: skip
