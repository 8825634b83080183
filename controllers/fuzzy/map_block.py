"""A fuzzy system as a block without memory: to draw its surfaces, or to use it as a static map.

Outputs: those of the system, then the degree of every membership function. Inputs beyond the tops
of the outer triangles are left as they are; where no rule fires, an output keeps its value.
"""

from __future__ import annotations

import numpy as np

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require
from controllers.fuzzy.inference import FuzzySystem, infer

_N_OUT, _N_MU, _N_RULES, _AT_THETA = range(4)
_N_HEAD = 4


def fuzzy_map_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Inputs of the system in, its outputs and memberships out."""
    n_out = int(p[_N_OUT])
    n_mu = int(p[_N_MU])
    n_rules = int(p[_N_RULES])
    mu = y[n_out : n_out + n_mu]
    structure = p[_N_HEAD : int(p[_AT_THETA])]
    infer(structure, p[int(p[_AT_THETA]) :], u, mu, x[:n_rules], x[n_rules:], y[:n_out])


def fuzzy_map_block(
    system: FuzzySystem, inputs: tuple[Signal, ...], outputs: tuple[Signal, ...]
) -> Block:
    """The block of any system; membership function j of input i is `mu_i_j`, counted from 1."""
    sizes = (len(system.inputs), len(system.weights))
    given = (len(inputs), len(outputs))
    require(sizes == given, "fuzzy_map_block: inputs, outputs", f"{sizes} signals", given)
    structure, theta = system.structure(), system.theta()
    n_rules = len(system.rules)
    head = [len(outputs), system.n_functions, n_rules, _N_HEAD + len(structure)]
    p = np.concatenate([np.array(head, dtype=np.float64), structure, theta])
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
