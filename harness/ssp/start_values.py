"""Parameter bindings to start values of FMU variables.

A binding gives the values of a parameter set to the element that holds it: by the names of an
FMU's variables, or by the hierarchical names of all that is in a system. A value given to a
connector of a system goes on along its connections, with their units and transformations, and
counts more than what is bound to the other end. Else, of several values the one bound at the
higher level counts, at one level the later one. Values that fit no name are ignored, as the
standard says, and said so.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any
from warnings import warn

from harness.errors import at
from harness.fmi.start_values import configured, find_target, judge_start_values
from harness.ssp.change import Items
from harness.ssp.flatten import FlatWire, change_along
from harness.ssp.parameter_values import Value, bound_values
from harness.ssp.ports import Node, Ports
from harness.ssp.tree import FmuNode, SystemNode, TreePath

Bound = dict[Node, "_Bound"]
TreeNode = SystemNode | FmuNode


@dataclass(frozen=True)
class _Bound:
    """A value in the unit of the node to which it is bound; the higher `rank` counts."""

    value: Value
    rank: tuple[int, int]
    place: str


def start_values(ports: Ports, wires: tuple[FlatWire, ...]) -> dict[TreePath, dict[str, Any]]:
    """The start values of each FMU by variable, in the order in which they are bound."""
    bound: Bound = {}
    order = 0
    for node in sorted(ports.tree.nodes, key=lambda one: len(one.path)):
        fmu = node.element.source if isinstance(node, FmuNode) else None
        for one, scope in node.bindings:
            place = f"{scope.where}: parameter binding of {'.'.join(node.path) or 'the system'}"
            with at(place):
                values = list(bound_values(one, scope, fmu, place))
            for name, value in values:
                order += 1
                given = _Bound(value, (-len(node.path), order), f"{place}: {name}")
                _give(bound, ports, node, name, given)
    _propagate(bound, wires, ports)
    raw: dict[TreePath, dict[str, Any]] = {}
    for end, given in bound.items():
        if end.path in ports.tree.fmu_at and not end.dictionary:
            items = given.value.items or ports.port(end).items or {}
            raw.setdefault(end.path, {})[end.name] = _content(given.value, items)
    return {path: _judged(path, values, bound, ports) for path, values in raw.items()}


def _judged(path: TreePath, values: dict[str, Any], bound: Bound, ports: Ports) -> dict[str, Any]:
    """The values of one FMU in the types of its variables; a fault names the binding."""
    found = dict(values)
    d = configured(ports.describe(ports.tree.fmu_at[path].source), values)
    for name, value in values.items():
        with at(bound[Node(path, name)].place):
            told = judge_start_values(d, {name: value}, component=".".join(path)).told
        found[name] = told.get(name, value)
    return found


def _content(value: Value, items: Items) -> Any:
    made = [items.get(one, one) if isinstance(one, str) else one for one in value.content]
    return made[0] if len(made) == 1 and not value.array else made


def _give(bound: Bound, ports: Ports, node: TreeNode, name: str, given: _Bound) -> None:
    """Bind a value to every variable and connector of that hierarchical name."""
    ends = list(_named(ports, node, name))
    if not ends:
        warn(f"{given.place} fits no variable and is ignored", stacklevel=2)
    for end in ends:
        if end in bound and bound[end].rank > given.rank:
            continue
        with at(given.place):
            bound[end] = replace(given, value=given.value.settled(ports.port(end)))


def _named(ports: Ports, node: TreeNode, name: str) -> Iterator[Node]:
    depth = len(node.path)
    for one in ports.tree.nodes:
        prefix = "".join(f"{part}." for part in one.path[depth:])
        if one.path[:depth] != node.path or not name.startswith(prefix):
            continue
        rest = name[len(prefix) :]
        if isinstance(one, SystemNode):
            known = one.element.connector(rest) is not None
        else:
            known = find_target(ports.describe(one.source), rest) is not None
        if known:
            yield Node(one.path, rest)


def _propagate(bound: Bound, wires: tuple[FlatWire, ...], ports: Ports) -> None:
    """Values of connectors that nothing drives go to the FMUs' inputs and parameters behind.

    What is connected takes the value of its connection, whatever is bound to it besides.
    """
    for wire in wires:
        for index, edge in enumerate(() if wire.driven else wire.edges):
            given, own = bound.get(edge.source), bound.get(wire.target)
            if given is None:
                continue
            if own is not None:
                warn(f"{own.place} is not used: {edge.place} gives the value", stacklevel=2)
            change = change_along(wire.edges[index:], ports, given.value.unit)
            with at(given.place):
                bound[wire.target] = replace(given, value=given.value.changed(change))
            break
