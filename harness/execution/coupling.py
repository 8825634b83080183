"""The order in which coupled FMUs are read and written at one instant.

Outputs that depend directly on inputs are read after those inputs have been written. Each stage
reads some outputs and passes them on to the inputs on which outputs of later stages depend.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import networkx as nx

from harness.errors import GraphError
from harness.fmi.model_description import ModelDescription
from harness.system.graph import Endpoint
from harness.system.lowering import Wire


@dataclass(frozen=True)
class Stage:
    """Wires to copy and write first, then outputs to read."""

    wires: tuple[Wire, ...]
    outputs: tuple[Endpoint, ...]


def feeding_inputs(
    output: Endpoint, descriptions: Mapping[str, ModelDescription]
) -> frozenset[Endpoint]:
    """The inputs on which an FMU's output depends directly, all of them where it does not say."""
    description = descriptions[output.component]
    names = description.feedthrough.get(output.variable)
    if names is None:
        if description.variables[output.variable].causality != "output":
            return frozenset()
        names = tuple(v.name for v in description.inputs)
    return frozenset(Endpoint(output.component, name) for name in names)


def coupling_stages(
    outputs: Iterable[Endpoint],
    wires: Iterable[Wire],
    descriptions: Mapping[str, ModelDescription],
) -> tuple[Stage, ...]:
    """Stages that read `outputs`, passing values along `wires` where outputs depend on them.

    `wires` lead to FMU inputs, from FMU outputs or from values known beforehand. Raises
    `GraphError` with the ports of an algebraic loop.
    """
    outputs = tuple(dict.fromkeys(outputs))
    feeding = {output: feeding_inputs(output, descriptions) for output in outputs}
    needed = frozenset().union(*feeding.values())
    early = [wire for wire in wires if wire.target in needed]
    graph = nx.DiGraph()
    graph.add_nodes_from(outputs)
    for wire in early:
        graph.add_edge(wire.source, wire.target)
    for output in outputs:
        graph.add_edges_from((end, output) for end in feeding[output] if graph.has_node(end))
    try:
        order = list(nx.topological_sort(graph))
    except nx.NetworkXUnfeasible:
        loop = [edge[0] for edge in nx.find_cycle(graph)]
        path = " -> ".join(map(str, [*loop, loop[0]]))
        raise GraphError(
            f"algebraic loop by direct feedthrough: {path}; put a delay on one of these wires"
        ) from None
    level: dict[Endpoint, int] = {}
    for node in order:
        steps = [level[before] + (node in feeding) for before in graph.predecessors(node)]
        level[node] = max(steps, default=0)
    depth = max((level[output] for output in outputs), default=0)
    return tuple(
        Stage(
            tuple(wire for wire in early if level[wire.target] == stage - 1),
            tuple(output for output in outputs if level[output] == stage),
        )
        for stage in range(depth + 1)
    )
