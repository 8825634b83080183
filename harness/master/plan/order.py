"""The order in which coupled FMUs are read and written at one instant.

Outputs that depend directly on inputs are read after those inputs have been written. Each stage
reads some outputs and passes them on to the inputs on which outputs of later stages depend. Ports
that depend on each other in a circle, an algebraic loop, share a stage; whoever cannot solve it
refuses it here, port by port.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import networkx as nx

from harness.errors import GraphError
from harness.fmi.description.model_description import ModelDescription
from harness.system.graph import Endpoint
from harness.system.lowering import Wire

Feeding = Callable[[Endpoint], frozenset[Endpoint]]
"""The inputs on which an FMU's output depends directly."""


@dataclass(frozen=True)
class Loop:
    """An algebraic loop: wires and outputs that depend on each other in a circle."""

    wires: tuple[Wire, ...]
    outputs: tuple[Endpoint, ...]


@dataclass(frozen=True)
class Stage:
    """Wires to copy and write first, then loops to solve, then outputs to read."""

    wires: tuple[Wire, ...]
    outputs: tuple[Endpoint, ...]
    loops: tuple[Loop, ...] = ()

    @property
    def every_wire(self) -> tuple[Wire, ...]:
        """All wires of the stage."""
        return (*self.wires, *(wire for loop in self.loops for wire in loop.wires))

    @property
    def every_output(self) -> tuple[Endpoint, ...]:
        """All outputs of the stage."""
        return (*self.outputs, *(end for loop in self.loops for end in loop.outputs))


def feeding_inputs(
    output: Endpoint, descriptions: Mapping[str, ModelDescription], *, initially: bool = False
) -> frozenset[Endpoint]:
    """The inputs on which an FMU's output depends directly, all of them where it does not say.

    `initially`: during initialisation, where the FMU says something else of that.
    """
    description = descriptions[output.component]
    array, _ = description.elements.get(output.variable, (None, 0))
    variable = array or description.variable(output.variable)
    names = description.feedthrough.get(variable.name)
    if initially:
        names = description.initial_feedthrough.get(variable.name, names)
    if names is None:
        if variable.causality != "output":
            return frozenset()
        names = tuple(v.name for v in description.inputs)
    return frozenset(
        Endpoint(output.component, port) for name in names for port in description.whole(name)
    )


def coupling_stages(
    outputs: Iterable[Endpoint],
    wires: Iterable[Wire],
    feeding: Feeding,
    *,
    solve: bool = False,
    initially: bool = False,
) -> tuple[Stage, ...]:
    """Stages that read `outputs`, passing values along `wires` where outputs depend on them.

    `wires` lead to FMU inputs, from FMU outputs or from values known beforehand. Unless they are
    to be solved, raises `GraphError` with the ports of an algebraic loop; `initially` says that it
    is one during initialisation.
    """
    outputs = tuple(dict.fromkeys(outputs))
    needs = {output: feeding(output) for output in outputs}
    needed = frozenset().union(*needs.values())
    early = [wire for wire in wires if wire.target in needed]
    graph = nx.DiGraph()
    graph.add_nodes_from(outputs)
    for wire in early:
        graph.add_edge(wire.source, wire.target)
    for output in outputs:
        graph.add_edges_from((end, output) for end in needs[output] if graph.has_node(end))
    levels = _Levels(graph, frozenset(outputs))
    if levels.circles and not solve:
        first = min(levels.circles)
        circle = [end for end, group in levels.circle.items() if group == first]
        raise GraphError(_loop_fault(graph.subgraph(circle), initially))
    return _stages(levels, early, outputs)


def _stages(levels: _Levels, early: list[Wire], outputs: tuple[Endpoint, ...]) -> tuple[Stage, ...]:
    level, circle = levels.level, levels.circle
    stages = []
    for number in range(max((level[output] for output in outputs), default=0) + 1):
        here = sorted({c for c, place in levels.circles.items() if place == number})
        loops = tuple(
            Loop(
                tuple(w for w in early if circle.get(w.target) == c == circle.get(w.source)),
                tuple(end for end in outputs if circle.get(end) == c),
            )
            for c in here
        )
        plain = [w for w in early if level[w.target] == number - 1 and w.target not in circle]
        read = tuple(end for end in outputs if level[end] == number and end not in circle)
        stages.append(Stage(tuple(plain), read, loops))
    return tuple(stages)


class _Levels:
    """The stage of every port: `level`; of an input that of the value that comes to it.

    `circle` is the number of the algebraic loop that a port belongs to, `circles` the stages of
    the loops.
    """

    def __init__(self, graph: nx.DiGraph[Endpoint], outputs: frozenset[Endpoint]) -> None:
        self.level: dict[Endpoint, int] = {}
        self.circle: dict[Endpoint, int] = {}
        self.circles: dict[int, int] = {}
        condensed = nx.condensation(graph)
        for group in nx.topological_sort(condensed):
            members: set[Endpoint] = condensed.nodes[group]["members"]
            if len(members) > 1:
                before = {p for node in members for p in graph.predecessors(node)} - members
                place = max((self.level[p] + 1 for p in before), default=0)
                self.circle |= dict.fromkeys(members, group)
                self.circles[group] = place
                self.level |= dict.fromkeys(members, place)
                continue
            (node,) = members
            steps = [self.level[before] + (node in outputs) for before in graph.predecessors(node)]
            self.level[node] = max(steps, default=0)


def _loop_fault(graph: nx.DiGraph[Endpoint], initially: bool) -> str:
    loop = [edge[0] for edge in nx.find_cycle(graph)]
    path = " -> ".join(map(str, [*loop, loop[0]]))
    when = " during initialisation" if initially else ""
    return (
        f"algebraic loop by direct feedthrough{when}: {path}; put a delay on one of these wires, "
        'or let it be solved: algebraic_loops = "solve"'
    )
