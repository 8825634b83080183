"""One row (x_k, y_k) learnt by a Takagi–Sugeno model: prediction and filter step, as a block.

    ŷ_k = h(x_k, p),   p ← filter step with y_k − ŷ_k            `adaptation`

Inputs are x_k, then y_k; outputs ŷ_k, γ_k, then νᵀS⁻¹ν. It is no controller: it is what
`offline.identify` runs over its rows, interpreted or compiled as any block.

Block arrays: p is the places of `TABLES` and of `STATE`, then `TABLES`: s, c; x is `STATE`.
"""

from __future__ import annotations

import numpy as np

from controllers.core.block import Array, Block, Signal
from controllers.core.layout import Layout, part
from controllers.fuzzy.takagi_sugeno import TakagiSugeno
from controllers.fuzzy.takagi_sugeno_kernels import model_jacobian, model_outputs, model_work
from controllers.identification.adaptation import Adaptation, adapt

STATE = Layout.of(
    theta="theta", P="covariance", predicted="outputs", innovation="outputs", gamma="outputs",
    H=("outputs", "theta"), work="work",
)  # fmt: skip
X_THETA, X_P, X_PREDICTED, X_INNOVATION, X_GAMMA, X_H, X_WORK = map(STATE.number, STATE.names)
TABLES = Layout.of(s="structure", c="constants")
STRUCTURE, CONSTANTS = map(TABLES.number, TABLES.names)
P_IN_STATE = TABLES.entries


def learner(model: TakagiSugeno, adaptation: Adaptation) -> Block:
    """The block that adapts `model`, eqs (8)–(15) by `adaptation`; θ and P are the first parts of
    its `STATE`. The adaptation must have as many parameters and outputs; `identify` checks it."""
    s, c, m = model.structure(), adaptation.constants(), len(model.models)
    values = {"theta": model.theta(), "P": adaptation.covariance()}
    tables = {"structure": len(s), "constants": len(c)}
    sizes = {
        "theta": len(values["theta"]), "covariance": len(values["P"]), "outputs": m,
        "work": max(model_work(s), adaptation.work()),
    }  # fmt: skip
    head = TABLES.entries + STATE.entries
    places = (TABLES.table(head, **tables), STATE.table(**sizes))
    told = [f"{word}_{o + 1}" for word in ("predicted", "gamma") for o in range(m)]
    given = [f"x_{i + 1}" for i in range(len(model.inputs))] + [f"y_{o + 1}" for o in range(m)]
    return Block(
        inputs=tuple(map(Signal, given)),
        outputs=tuple(map(Signal, (*told, "nis"))),
        step=learn_row,
        parameters=np.concatenate([*places, TABLES.fill({"s": s, "c": c}, **tables)]),
        state=STATE.fill(values, **sizes),
    )


def state(p: Array, x: Array, which: int) -> Array:
    """A part of `STATE`, a view into x."""
    return part(p[P_IN_STATE:], x, which)


def learn_row(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `learner`: u (n + m,) is a row (x_k, y_k), y (2·m + 1,) what is told of it. Where no
    rule fires for an output its prediction is the one before."""
    s = part(p, p, STRUCTURE)
    theta = state(p, x, X_THETA)
    predicted = state(p, x, X_PREDICTED)
    innovation = state(p, x, X_INNOVATION)
    gamma = state(p, x, X_GAMMA)
    work = state(p, x, X_WORK)
    H = state(p, x, X_H)
    m = predicted.shape[0]
    n = u.shape[0] - m
    model_outputs(s, theta, u[:n], predicted, work)
    model_jacobian(s, theta, u[:n], predicted, H, work)
    for o in range(m):
        innovation[o] = u[n + o] - predicted[o]
    y[2 * m] = adapt(
        part(p, p, CONSTANTS), theta, state(p, x, X_P), innovation, H, gamma, work
    )  # fmt: skip
    for o in range(m):
        y[o] = predicted[o]
        y[m + o] = gamma[o]
