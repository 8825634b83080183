"""Iterative: FMUs that drive each other repeat a step until it agrees with what they reach.

A strongly connected group of FMU-to-FMU wires steps from a snapshot, is compared with what its
members took as the values of the end, and steps again; the groups step one after the other as in
Gauss–Seidel. It refuses to repeat FMUs whose state cannot be restored.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar

import networkx as nx

from harness.master.algorithms.base import Groups
from harness.master.algorithms.gauss_seidel import CHANGE_REACHED, GaussSeidel
from harness.master.plan.actions import (
    Action,
    Blend,
    Iterate,
    Read,
    Restore,
    Save,
    Step,
    Transfer,
    UnlessStop,
)
from harness.system.lowering import LoweredSystem, Wire


class Iterative(GaussSeidel):
    """Groups of FMUs that drive each other, one after the other."""

    solves_loops: ClassVar[bool] = True

    @classmethod
    def together(cls, lowered: LoweredSystem) -> Groups:
        """The groups of FMUs that drive each other, in the order of the components."""
        graph = _graph(lowered)
        rank = {name: i for i, name in enumerate(graph)}
        groups = [
            tuple(sorted(members, key=rank.__getitem__))
            for members in nx.strongly_connected_components(graph)
            if len(members) > 1 or any(graph.has_edge(name, name) for name in members)
        ]
        return tuple(sorted(groups, key=lambda group: rank[group[0]]))

    def refusal(self) -> str:
        """All of a group must save and restore their state."""
        for group in self.together(self.lowered):
            able = self.capabilities
            lacking = [name for name in group if not able[name].can_get_and_set_fmu_state]
            if lacking:
                return (
                    f"the iterative algorithm repeats the steps of {', '.join(group)}, which drive "
                    f"each other, but the state of {', '.join(lacking)} cannot be saved and "
                    "restored (canGetAndSetFMUState); use jacobi or gauss-seidel"
                )
        return ""

    def knows_end(self, wire: Wire) -> bool:
        """Of all: groups step before those that they drive, and agree among themselves."""
        return True

    def advance(self, due: Mapping[str, int]) -> Iterator[Action]:
        """One group after the other."""
        repeated = self.together(self.lowered)
        if repeated:
            yield UnlessStop()
        for group in _in_order(self.lowered, repeated):
            if group[0] in due:
                alone = group not in repeated
                yield from (
                    self.in_turn(group[0], due[group[0]]) if alone else self._repeat(group, due)
                )

    def _repeat(self, group: tuple[str, ...], due: Mapping[str, int]) -> Iterator[Action]:
        wires = [wire for name in group for wire in self.wires_to[name]]
        inner = tuple(wire for wire in wires if wire.source.component in group)
        outer = tuple(wire for wire in wires if wire.source.component not in group)
        linear, sloped = self.parted(wire for wire in inner if wire.linear)
        outer_linear, outer_sloped = self.parted(wire for wire in outer if wire.linear)
        body: list[Action] = [Restore(name) for name in group]
        body += _mean(linear, outer_linear)
        body += self.slopes(sloped, 1.0, (("present", -1.0),))
        body += self.slopes(outer_sloped, 0.0, CHANGE_REACHED)
        if sloped or outer_sloped:
            body.append(Transfer((*sloped, *outer_sloped)))
        body += self.write(group)
        body += [Step(name, due[name], final=False) for name in group]
        if self.feeding([*linear, *outer_linear]):
            body += _end(linear, outer_linear)
            body += self.write(group)
        body += [Read(name, self.reached[name], "reached") for name in group]
        if outer:
            yield Transfer(outer, "reached")
        yield from (Save(name) for name in group)
        yield Iterate(inner, "reached", tuple(body))


def _end(linear: tuple[Wire, ...], outer: tuple[Wire, ...]) -> Iterator[Action]:
    """From the middle of the step to its end."""
    if linear:
        yield Blend(linear, 2.0, (("present", -1.0),))
    if outer:
        yield Transfer(outer, "reached")


def _mean(linear: tuple[Wire, ...], outer: tuple[Wire, ...]) -> Iterator[Action]:
    """The values in the middle of the step, from those at its end."""
    if outer:
        yield Transfer(outer, "reached")
    if linear or outer:
        yield Blend((*linear, *outer), 0.5, (("present", 0.5),))


def _graph(lowered: LoweredSystem) -> nx.DiGraph[str]:
    graph: nx.DiGraph[str] = nx.DiGraph()
    graph.add_nodes_from(c.name for c in lowered.fmus)
    graph.add_edges_from((w.source.component, w.target.component) for w in lowered.fmu_wires)
    return graph


def _in_order(lowered: LoweredSystem, groups: Groups) -> list[tuple[str, ...]]:
    """Groups and single FMUs, each after those that drive it, else in the order of components."""
    graph = _graph(lowered)
    rank = {name: i for i, name in enumerate(graph)}
    group_of = {name: (name,) for name in graph} | {n: group for group in groups for n in group}
    condensed: nx.DiGraph[tuple[str, ...]] = nx.DiGraph()
    condensed.add_nodes_from(group_of.values())
    for source, target in graph.edges:
        if group_of[source] != group_of[target]:
            condensed.add_edge(group_of[source], group_of[target])
    return list(nx.lexicographical_topological_sort(condensed, key=lambda group: rank[group[0]]))
