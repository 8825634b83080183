"""How coupled FMUs step from one instant to the next: the algorithms, as orders of actions.

    jacobi        all FMUs take the values of the beginning of the step.
    gauss-seidel  FMUs step one after the other; each takes what those before it have reached.
    iterative     FMUs that drive each other (a strongly connected group of FMU-to-FMU wires)
                  repeat the step from a snapshot until what they took for it is what they reach;
                  the groups step one after the other as in Gauss–Seidel.

An input is constant during a step. On a wire with hold it has the value of one end of the step;
on a linear one that of its middle: between the two ends where the second one is known, and
otherwise along the line through the last two values,

    (y_k + y_k+1) / 2,        y_k + (y_k - y_k-1) / 2.

An FMI 2 FMU that can interpolate its inputs (canInterpolateInputs) gets the value of the beginning
and the slope to the end instead. Either way the mean differs from that of the true signal by O(h²),
so the error of a run is O(h²), against O(h) with hold. In the first step there is no earlier value,
and the line is horizontal. Where an output that depends directly on such an input is read at the
end of the step, the input gets the value of the end before.

It refuses linear wires between FMUs that do not communicate at the same, evenly spaced instants,
and to iterate FMUs whose state cannot be restored.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

import networkx as nx

from harness.clock import show
from harness.errors import GraphError, TimingError
from harness.fmi.description.model_description import ModelDescription
from harness.master.plan.actions import (
    Action,
    Blend,
    Iterate,
    Keep,
    Read,
    Restore,
    Save,
    Slope,
    Step,
    Transfer,
    UnlessStop,
    Write,
)
from harness.master.plan.order import feeding_inputs
from harness.participants.memory import View
from harness.system.graph import Endpoint
from harness.system.lowering import LoweredSystem, Wire

Terms = tuple[tuple[View, float], ...]

_AHEAD: Terms = (("present", 0.5), ("previous", -0.5))
"""From the value at the beginning of a step to that in its middle, and from there to its end."""
_CHANGE_AHEAD: Terms = (("present", 1.0), ("previous", -1.0))
_CHANGE_REACHED: Terms = (("reached", 1.0), ("present", -1.0))
"""From the value at the beginning of a step to that at its end."""


class Master:
    """The actions by which the FMUs of a system step."""

    def __init__(
        self,
        lowered: LoweredSystem,
        descriptions: Mapping[str, ModelDescription],
        grid: Mapping[str, Sequence[int]],
        written: Mapping[str, tuple[str, ...]],
    ) -> None:
        """`grid` are the communication points of each FMU in a cycle, `written` its inputs that
        are written. Raises `GraphError` or `TimingError`."""
        self.algorithm = lowered.system.algorithm
        self.descriptions = descriptions
        self.written = written
        self.step_ns = {c.name: c.step_ns for c in lowered.fmus}
        names = list(self.step_ns)
        self.wires_to: dict[str, list[Wire]] = {name: [] for name in names}
        for wire in fmu_wires(lowered):
            self.wires_to[wire.target.component].append(wire)
        self._check_grids(grid)
        capabilities = {name: descriptions[name].co_simulation for name in names}
        self.interpolating = {
            name for name, c in capabilities.items()
            if c is not None and c.can_interpolate_inputs and descriptions[name].fmi_major == 2
        }  # fmt: skip
        self.groups: list[tuple[str, ...]] = [(name,) for name in names]
        self.repeated: tuple[tuple[str, ...], ...] = ()
        if self.algorithm == "iterative":
            self.repeated = strong_groups(lowered)
            self.groups = _in_order(lowered, self.repeated)
            self._check_states()
        self.place = {name: i for i, group in enumerate(self.groups) for name in group}
        inner = [
            wire for group in self.repeated for name in group for wire in self._within(name, group)
        ]
        earlier = [wire for name in names for wire in self._earlier(name)]
        self.reached = by_component(wire.source for wire in [*earlier, *inner])
        self.extrapolated = by_component(w.source for name in names for w in self._ahead(name))

    def begin(self) -> Iterator[Action]:
        """What initialises a run, after all values have been propagated."""
        yield from (Keep(name, outputs) for name, outputs in self.extrapolated.items())

    def steps(self, due: Mapping[str, int]) -> Iterator[Action]:
        """The FMUs that are due step, by so many ns; their inputs have their present values."""
        if self.algorithm == "jacobi":
            yield from self._look_ahead(due)
            yield from self._write(due)
            yield from (Step(name, step_ns) for name, step_ns in due.items())
        else:
            if self.repeated:
                yield UnlessStop()
            for group in self.groups:
                if group in self.repeated and group[0] in due:
                    yield from self._repeat(group, due)
                elif group[0] in due:
                    yield from self._in_turn(group[0], due)
        for name in due:
            if name in self.extrapolated:
                yield Keep(name, self.extrapolated[name])

    # one FMU after the other

    def _in_turn(self, name: str, due: Mapping[str, int]) -> Iterator[Action]:
        yield from self._look_back(name)
        yield from self._look_ahead([name])
        yield from self._write([name])
        yield Step(name, due[name])
        if name in self.reached:
            between, _ = self._parted(self._feeding(w for w in self._earlier(name) if w.linear))
            ahead, _ = self._parted(self._feeding(self._ahead(name)))
            if between:
                yield Blend(between, 2.0, (("present", -1.0),))
            if ahead:
                yield Blend(ahead, 1.0, _AHEAD)
            if between or ahead:
                yield from self._write([name])
            yield Read(name, self.reached[name], "reached")

    def _look_back(self, name: str) -> Iterator[Action]:
        """Take from FMUs that have stepped what they have reached."""
        wires = self._earlier(name)
        held = tuple(wire for wire in wires if not wire.linear)
        if held:
            yield Transfer(held, "reached")
        middle, sloped = self._parted(wire for wire in wires if wire.linear)
        if middle:
            yield Blend(middle, 0.5, (("reached", 0.5),))
        yield from self._slopes(sloped, 0.0, _CHANGE_REACHED)

    def _look_ahead(self, names: Iterable[str]) -> Iterator[Action]:
        middle, sloped = self._parted(wire for name in names for wire in self._ahead(name))
        if middle:
            yield Blend(middle, 1.0, _AHEAD)
        yield from self._slopes(sloped, 0.0, _CHANGE_AHEAD)

    # repeated steps

    def _repeat(self, group: tuple[str, ...], due: Mapping[str, int]) -> Iterator[Action]:
        inner = tuple(wire for name in group for wire in self._within(name, group))
        linear, sloped = self._parted(wire for wire in inner if wire.linear)
        outer = tuple(wire for name in group for wire in self._earlier(name))
        outer_linear, outer_sloped = self._parted(wire for wire in outer if wire.linear)
        body: list[Action] = [Restore(name) for name in group]
        body += _mean(linear, outer_linear)
        body += self._slopes(sloped, 1.0, (("present", -1.0),))
        body += self._slopes(outer_sloped, 0.0, _CHANGE_REACHED)
        if sloped or outer_sloped:
            body.append(Transfer((*sloped, *outer_sloped)))
        body += self._write(group)
        body += [Step(name, due[name], final=False) for name in group]
        if self._feeding([*linear, *outer_linear]):
            body += _end(linear, outer_linear)
            body += self._write(group)
        body += [Read(name, self.reached[name], "reached") for name in group]
        if outer:
            yield Transfer(outer, "reached")
        yield from (Save(name) for name in group)
        yield Iterate(inner, "reached", tuple(body))

    # wires

    def _within(self, name: str, group: Collection[str]) -> list[Wire]:
        return [wire for wire in self.wires_to[name] if wire.source.component in group]

    def _earlier(self, name: str) -> list[Wire]:
        """Wires from FMUs that step before this one, whose end of the step is known."""
        if self.algorithm == "jacobi":
            return []
        before = self.place[name]
        return [w for w in self.wires_to[name] if self.place[w.source.component] < before]

    def _ahead(self, name: str) -> list[Wire]:
        """Linear wires from FMUs whose end of the step is not known yet."""
        if self.algorithm == "iterative":
            return []
        earlier = self._earlier(name)
        return [wire for wire in self.wires_to[name] if wire.linear and wire not in earlier]

    def _feeding(self, wires: Iterable[Wire]) -> tuple[Wire, ...]:
        """Those on which outputs that are read at the end of the step depend directly."""
        found = []
        for wire in wires:
            name = wire.target.component
            outputs = [Endpoint(name, output) for output in self.reached.get(name, ())]
            if any(wire.target in feeding_inputs(end, self.descriptions) for end in outputs):
                found.append(wire)
        return tuple(found)

    def _parted(self, wires: Iterable[Wire]) -> tuple[tuple[Wire, ...], tuple[Wire, ...]]:
        """Linear wires that bring the value of the middle, and those that bring a slope."""
        wires = tuple(wires)
        sloped = tuple(w for w in wires if w.target.component in self.interpolating)
        return tuple(w for w in wires if w not in sloped), sloped

    def _slopes(self, wires: tuple[Wire, ...], own: float, terms: Terms) -> Iterator[Slope]:
        for name in by_component(wire.target for wire in wires):
            into = tuple(wire for wire in wires if wire.target.component == name)
            yield Slope(name, into, own, terms, self.step_ns[name])

    def _write(self, names: Iterable[str]) -> Iterator[Write]:
        return (Write(name, self.written[name]) for name in names if name in self.written)

    # refusals

    def _check_grids(self, grid: Mapping[str, Sequence[int]]) -> None:
        for name, wires in self.wires_to.items():
            for wire in wires:
                source = wire.source.component
                uneven = any(offset % self.step_ns[name] for offset in grid[name])
                if wire.linear and (uneven or grid[source] != grid[name]):
                    raise TimingError(
                        f"connection {wire.source} -> {wire.target} is extrapolated, for which "
                        f"{source} and {name} must communicate at the same, evenly spaced "
                        f"instants: {_spacing(source, grid)}, {_spacing(name, grid)}"
                    )

    def _check_states(self) -> None:
        for group in self.repeated:
            lacking = []
            for name in group:
                capabilities = self.descriptions[name].co_simulation
                if capabilities is None or not capabilities.can_get_and_set_fmu_state:
                    lacking.append(name)
            if lacking:
                raise GraphError(
                    f"the iterative algorithm repeats the steps of {', '.join(group)}, which drive "
                    f"each other, but the state of {', '.join(lacking)} cannot be saved and "
                    "restored (canGetAndSetFMUState); use jacobi or gauss-seidel"
                )


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


def fmu_wires(lowered: LoweredSystem) -> tuple[Wire, ...]:
    """The wires from FMU to FMU that nothing delays."""
    names = {c.name for c in lowered.fmus}
    return tuple(
        w for w in lowered.wires if w.source.component in names and w.target.component in names
    )


def strong_groups(lowered: LoweredSystem) -> tuple[tuple[str, ...], ...]:
    """The groups of FMUs that drive each other, in the order of the components."""
    graph = _graph(lowered)
    rank = {name: i for i, name in enumerate(graph)}
    groups = [
        tuple(sorted(members, key=rank.__getitem__))
        for members in nx.strongly_connected_components(graph)
        if len(members) > 1 or any(graph.has_edge(name, name) for name in members)
    ]
    return tuple(sorted(groups, key=lambda group: rank[group[0]]))


def by_component(ends: Iterable[Endpoint]) -> dict[str, tuple[str, ...]]:
    """The distinct variables of each component, in order."""
    grouped: dict[str, dict[str, None]] = {}
    for end in ends:
        grouped.setdefault(end.component, {})[end.variable] = None
    return {name: tuple(variables) for name, variables in grouped.items()}


def _graph(lowered: LoweredSystem) -> nx.DiGraph[str]:
    graph: nx.DiGraph[str] = nx.DiGraph()
    graph.add_nodes_from(c.name for c in lowered.fmus)
    graph.add_edges_from((w.source.component, w.target.component) for w in fmu_wires(lowered))
    return graph


def _in_order(lowered: LoweredSystem, groups: tuple[tuple[str, ...], ...]) -> list[tuple[str, ...]]:
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


def _spacing(name: str, grid: Mapping[str, Sequence[int]]) -> str:
    return f"{name} at {', '.join(map(show, grid[name][:4]))}" + (
        ", …" if len(grid[name]) > 4 else ""
    )
