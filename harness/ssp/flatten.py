"""Nested systems to wires between FMUs: each wire with what happens to the value on its way.

Which end of a connection is the source is decided by the kinds of its connectors, not by which is
called its start. A signal is followed from the input of an FMU back through connectors of systems
and signal dictionaries to the output that feeds it. At each connector whose unit is known the
value is converted to it; a unit that is not stated stays that of the source.

Refused are connections of two sources or two inputs, inputs fed twice, circles of connectors, and
connections of single elements of arrays.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from harness.errors import ExperimentError, at, nearest
from harness.ssp.change import Change, transformed
from harness.ssp.document import Connection, DictionaryReference
from harness.ssp.ports import SINKS, SOURCES, Node, Ports
from harness.ssp.tree import SystemNode, Tree
from harness.system.units import Unit, exact_conversion


@dataclass(frozen=True)
class Edge:
    """A connection with its direction known; `place` names it in faults."""

    source: Node
    target: Node
    connection: Connection
    place: str


@dataclass(frozen=True)
class FlatWire:
    """What feeds the input `target` of an FMU: over `edges`, from the source on.

    `source` is an output of an FMU where `driven`, else a connector that nothing feeds.
    """

    source: Node
    target: Node
    edges: tuple[Edge, ...]
    driven: bool


def flat_wires(ports: Ports) -> tuple[FlatWire, ...]:
    """All wires that end at an FMU, in the order of the connections that reach it."""
    tree = ports.tree
    incoming: dict[Node, Edge] = {}
    for edge in (_directed(s, c, ports) for s in tree.systems for c in s.element.connections):
        other = incoming.setdefault(edge.target, edge)
        if other is not edge:
            raise ExperimentError(
                f"{edge.place}: {edge.target} is fed twice, from {other.source} and {edge.source}; "
                "leave one of the connections out"
            )
    ends = [node for node in incoming if node.path in tree.fmu_at and not node.dictionary]
    return tuple(_followed(node, incoming, tree) for node in ends)


def _followed(target: Node, incoming: Mapping[Node, Edge], tree: Tree) -> FlatWire:
    node = target
    edges: list[Edge] = []
    while node in incoming:
        edge = incoming[node]
        if edge in edges:
            circle = " -> ".join(str(one.source) for one in reversed(edges))
            raise ExperimentError(
                f"{edge.place}: connectors feed one another in a circle: {circle}; "
                "let one of them take its value from an output of an FMU"
            )
        edges.append(edge)
        node = edge.source
        if node.path in tree.fmu_at and not node.dictionary:
            break
    driven = node.path in tree.fmu_at and not node.dictionary
    return FlatWire(node, target, tuple(reversed(edges)), driven)


def change_along(edges: tuple[Edge, ...], ports: Ports, unit: Unit | None) -> Change:
    """What happens to a value in a `unit` on its way; raises `ExperimentError`."""
    change = Change()
    for edge in edges:
        source, target = ports.port(edge.source), ports.port(edge.target)
        c = edge.connection
        with at(edge.place):
            if not c.suppress_unit_conversion:
                change = change.scaled(*exact_conversion(unit, target.unit))
            if c.transformation is not None:
                change = transformed(change, c.transformation, source.items, target.items)
        if target.unit is not None or c.transformation is not None or c.suppress_unit_conversion:
            unit = target.unit
    boolean = edges and ports.port(edges[0].source).type == "Boolean"
    return change.boolean() if boolean else change


def _directed(system: SystemNode, c: Connection, ports: Ports) -> Edge:
    ends = [(c.start_element, c.start_connector), (c.end_element, c.end_connector)]
    start, end = (f"{element}.{name}" if element else name for element, name in ends)
    inside = f" of system {'.'.join(system.path)}" if system.path else ""
    place = f"{system.scope.where}: connection {start} – {end}{inside}"
    with at(place):
        if c.start_indices or c.end_indices:
            raise ExperimentError("single elements of arrays are not connected; connect whole ones")
        first, second = (_node(system, element, name, ports) for element, name in ends)
        roles = [
            _role(ports.port(node).kind, own=not element)
            for node, (element, _) in zip((first, second), ends, strict=True)
        ]
        if roles[0] and roles[0] == roles[1]:
            what = "give values" if roles[0] == "source" else "take values"
            raise ExperimentError(f"both connectors {what}; one must be of the other kind")
    if roles[0] == "sink" or roles[1] == "source":
        return Edge(second, first, c, place)
    return Edge(first, second, c, place)


def _role(kind: str, *, own: bool) -> str:
    """Whether a connector gives or takes values inside the system ("" where either is meant)."""
    if kind in SOURCES:
        return "sink" if own else "source"
    if kind in SINKS:
        return "source" if own else "sink"
    return ""


def _node(system: SystemNode, element: str | None, connector: str, ports: Ports) -> Node:
    """The connector of an element, or of the system itself: some tools write "" for no element."""
    if not element:
        return Node(system.path, connector)
    found = {one.name: one for one in system.element.elements}
    if element not in found:
        raise ExperimentError(f"there is no element {element!r}; {nearest(element, found)}")
    one = found[element]
    if isinstance(one, DictionaryReference):
        return ports.referred(system.path, one, connector)
    return Node((*system.path, element), connector)
