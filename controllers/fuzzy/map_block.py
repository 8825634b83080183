"""A fuzzy system as a block without memory: to draw its surfaces, or to use it as a static map.

Outputs: those of the system, then the degree of every membership function. Inputs beyond the tops
of the outer triangles are left as they are; where no rule fires, an output keeps its value.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require
from controllers.core.layout import Layout, part
from controllers.fuzzy.inference import FuzzySystem, infer

SYSTEM = Layout.of(structure="structure", theta="theta")
HEAD = Layout.of(outputs=(), functions=(), rules=(), in_parameters=SYSTEM.entries)
N_OUTPUTS, N_FUNCTIONS, N_RULES, IN_PARAMETERS = HEAD.places()
STRUCTURE, THETA = map(SYSTEM.number, SYSTEM.names)


def fuzzy_map_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Inputs of the system in, its outputs and memberships out."""
    n_out = int(p[N_OUTPUTS])
    n_rules = int(p[N_RULES])
    mu = y[n_out : n_out + int(p[N_FUNCTIONS])]
    structure = part(p[IN_PARAMETERS:], p, STRUCTURE)
    theta = part(p[IN_PARAMETERS:], p, THETA)
    infer(structure, theta, u, mu, x[:n_rules], x[n_rules:], y[:n_out])


def fuzzy_map_block(
    system: FuzzySystem, inputs: tuple[Signal, ...], outputs: tuple[Signal, ...]
) -> Block:
    """The block of any system; membership function j of input i is `mu_i_j`, counted from 1."""
    counts = (len(system.inputs), len(system.weights))
    given = (len(inputs), len(outputs))
    require(counts == given, "fuzzy_map_block: inputs, outputs", f"{counts} signals", given)
    structure, theta = system.structure(), system.theta()
    n_rules = len(system.rules)
    sizes = {"structure": len(structure), "theta": len(theta)}
    head: dict[str, ArrayLike] = {
        "outputs": len(outputs),
        "functions": system.n_functions,
        "rules": n_rules,
        "in_parameters": SYSTEM.table(HEAD.length, **sizes),
    }
    tables = SYSTEM.fill({"structure": structure, "theta": theta}, **sizes)
    p = np.concatenate([HEAD.fill(head), tables])
    work = n_rules + system.n_weights
    return Block(
        inputs=inputs,
        outputs=(
            *outputs,
            *(
                Signal(f"mu_{i}_{j}", "1", f"membership function {j} of {signal.name}")
                for i, signal in enumerate(inputs, start=1)
                for j in range(1, len(system.inputs[i - 1]) + 1)
            ),
        ),
        step=fuzzy_map_step,
        parameters=p,
        parameter_names=tuple(f"p_{i}" for i in range(len(p))),
        state=np.zeros(work),
        state_names=tuple(f"x_{i}" for i in range(work)),
    )
