"""The order in which coupled FMUs are read and written at one instant.

Outputs that depend directly on inputs are read after those inputs have been written. Each stage
reads some outputs and passes them on to the inputs on which outputs of later stages depend.

Ports that depend on each other in a circle are an algebraic loop. It may be

    held     an output in the loop is read with what its inputs in the loop had for the last step,
             so that the loop is broken by the values that are there (the start values in the
             initialisation); where the FMU does not say on what an output depends, that it depends
             on all inputs orders what can be ordered, and makes no loop of ports that do say;
    refused  port by port;
    solved   its ports share a stage, whose reads and writes are repeated until they agree.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

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
    d = descriptions[output.component]
    names = _declared(output, d, initially)
    if names is None:
        names = tuple(v.name for v in d.inputs)
    return frozenset(Endpoint(output.component, port) for name in names for port in d.scalars(name))


def assumed(
    output: Endpoint, descriptions: Mapping[str, ModelDescription], *, initially: bool = False
) -> bool:
    """Whether the FMU does not say on what its output depends."""
    return _declared(output, descriptions[output.component], initially) is None


def _declared(output: Endpoint, d: ModelDescription, initially: bool) -> tuple[str, ...] | None:
    array, _ = d.elements.get(output.variable, (None, 0))
    variable = array or d.variable(output.variable)
    names = d.feedthrough.get(variable.name)
    if initially:
        names = d.initial_feedthrough.get(variable.name, names)
    # slaves of FMI 1 compute their outputs in doStep; some have none between a set and that
    slave = d.fmi_major == 1 and d.co_simulation is not None
    return () if names is None and (slave or variable.causality != "output") else names


@dataclass
class Held:
    """`feeding` without what closes a loop, and a note on each loop that it closed."""

    feeding: dict[Endpoint, frozenset[Endpoint]]
    notes: dict[frozenset[Endpoint], str] = field(default_factory=dict)


def hold_loops(
    outputs: Iterable[Endpoint],
    wires: Iterable[Wire],
    feeding: Feeding,
    is_assumed: Callable[[Endpoint], bool],
) -> Held:
    """Break all loops: those that close by what is only assumed there, then the others."""
    outputs, wires = tuple(outputs), tuple(wires)
    held = Held({output: feeding(output) for output in outputs})
    for declared in (False, True):
        graph = _graph(held.feeding, wires)
        for loop in nx.strongly_connected_components(graph):
            if len(loop) == 1:
                continue
            if not declared:
                silent = by_component(end for end in outputs if end in loop and is_assumed(end))
                held.notes[frozenset(loop)] = _held_note(graph.subgraph(loop), silent)
            for output in loop & held.feeding.keys():
                if declared or is_assumed(output):
                    held.feeding[output] -= loop
    return held


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
    graph = _graph(needs, early)
    levels = _Levels(graph, frozenset(outputs))
    if levels.circles and not solve:
        first = min(levels.circles)
        circle = [end for end, group in levels.circle.items() if group == first]
        raise GraphError(_loop_fault(graph.subgraph(circle), initially))
    return _stages(levels, early, outputs)


def _graph(
    needs: Mapping[Endpoint, frozenset[Endpoint]], wires: Iterable[Wire]
) -> nx.DiGraph[Endpoint]:
    """Outputs and inputs, each after that on which it depends."""
    graph: nx.DiGraph[Endpoint] = nx.DiGraph()
    graph.add_nodes_from(needs)
    graph.add_edges_from((wire.source, wire.target) for wire in wires)
    for output, inputs in needs.items():
        graph.add_edges_from((end, output) for end in inputs if graph.has_node(end))
    return graph


def by_component(ends: Iterable[Endpoint]) -> dict[str, tuple[str, ...]]:
    """The distinct variables of each component, in order."""
    grouped: dict[str, dict[str, None]] = {}
    for end in ends:
        grouped.setdefault(end.component, {})[end.variable] = None
    return {name: tuple(variables) for name, variables in grouped.items()}


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
    when = " during initialisation" if initially else ""
    return (
        f"algebraic loop by direct feedthrough{when}: {_circle(graph)}; put a delay on one of "
        'these wires, or let it be solved or held: algebraic_loops = "solve" or "hold"'
    )


def _held_note(graph: nx.DiGraph[Endpoint], silent: Iterable[str]) -> str:
    names = ", ".join(silent)
    why = f" (assumed, as no dependencies are listed by {names})" if names else ""
    return (
        f"direct feedthrough in a circle: {_circle(graph)}{why}; at each communication point these "
        'outputs are those of the last step (algebraic_loops = "hold"); "solve" would repeat '
        "reading and writing until they agree"
    )


def _circle(graph: nx.DiGraph[Endpoint]) -> str:
    """A circle of a graph, port by port."""
    loop = [edge[0] for edge in nx.find_cycle(graph)]
    return " -> ".join(map(str, [*loop, loop[0]]))
