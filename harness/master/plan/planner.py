"""The planner: from a lowered system to a schedule of actions that repeats every cycle.

At each instant, in this order (the timing contract):

    0  delay lines whose value arrives now
    1  signals are sampled, FMU outputs are read, sensitivities computed
    2  blocks that are due compute, in the order of their wires
    3  what they computed goes to the FMU inputs and into delay lines, a row is recorded
    4  FMUs step to their next instant

The algorithms by which FMUs are coupled differ in part 4 only, which is theirs.

It refuses loops of blocks without delay, and loops of direct feedthrough where that is asked for;
`rates` refuses rates that do not fit together.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial

import networkx as nx

from harness.errors import GraphError
from harness.fmi.description.model_description import ModelDescription
from harness.master.algorithms.base import algorithm
from harness.master.plan.actions import (
    Action,
    Compute,
    Instant,
    Iterate,
    Linearise,
    Read,
    Record,
    Sample,
    Step,
    Transfer,
    Write,
)
from harness.master.plan.calendar import Calendar, Event, Role
from harness.master.plan.order import (
    Feeding,
    Stage,
    assumed,
    by_component,
    coupling_stages,
    feeding_inputs,
    hold_loops,
)
from harness.master.plan.rates import Rates
from harness.participants.memory import View
from harness.system.graph import (
    Component,
    Endpoint,
    FmuComponent,
    SampledComponent,
    SensitivityComponent,
    SignalComponent,
)
from harness.system.lowering import DelayComponent, LoweredSystem, Wire
from harness.system.policy import capabilities_of


@dataclass(frozen=True)
class Plan:
    """The schedule of one cycle, and what initialises a run.

    Instants at which the same things are due share one tuple of actions. `initial` propagates
    values once, before the first cycle; `read` and `written` are the FMU ports that the plan
    touches, each in the order in which they should lie in memory; `recorded` are the columns of a
    row. `events` record a row at an event inside a step of an FMU, by its name; `tail` are
    instants, counted from the start, after the last whole step. `notes` are sentences for the
    user on what was chosen for him.
    """

    lowered: LoweredSystem
    cycle_ns: int
    instants: tuple[Instant, ...]
    initial: tuple[Action, ...]
    read: tuple[Endpoint, ...]
    written: tuple[Endpoint, ...]
    recorded: tuple[Endpoint, ...]
    events: Mapping[str, tuple[Action, ...]] = field(default_factory=dict)
    tail: tuple[Instant, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def actions(self) -> tuple[Action, ...]:
        """All actions of the initialisation and of the distinct instants."""
        groups = [self.initial, *self.patterns, *self.events.values()]
        groups += [instant.actions for instant in self.tail]
        return tuple(action for actions in groups for action in actions)

    @property
    def patterns(self) -> tuple[tuple[Action, ...], ...]:
        """The distinct lists of actions of all instants."""
        return tuple({id(instant.actions): instant.actions for instant in self.instants}.values())


class Planner:
    """Plans a checked and lowered system; raises `GraphError` or `TimingError`."""

    def __init__(
        self,
        lowered: LoweredSystem,
        descriptions: Mapping[str, ModelDescription],
        recorded: tuple[Endpoint, ...],
    ) -> None:
        self.lowered = lowered
        self.system = lowered.system
        self.descriptions = descriptions
        self.recorded = recorded
        self.fmus = {c.name: c for c in lowered.fmus}
        self.by_name, self.wires_to = lowered.by_name, lowered.wires_to
        self.delays = [c for c in lowered.sampled if isinstance(c, DelayComponent)]
        kind = algorithm(self.system.algorithm)
        self.rates = Rates(lowered, descriptions, kind.together(lowered))
        self.cycle_ns = self.rates.cycle_ns
        self.blocks = self._order_blocks()
        self.loops = self.system.algebraic_loops
        if self.loops == "hold" and kind.solves_loops:
            self.loops = "solve"
        self.held: dict[frozenset[Endpoint], str] = {}
        self.initial_stages, _ = self._reading_stages(initially=True)
        self.stages, self.feeding = self._reading_stages()
        self.fresh = self._fresh_stages()
        self.written = self._written()
        self.algorithm = kind(lowered, descriptions, by_component(self.written))

    def plan(self) -> Plan:
        """The schedule."""
        instants = self._calendar().instants()
        distinct = dict.fromkeys(events for _, events in instants)
        patterns = {events: tuple(self._actions(events)) for events in distinct}
        return Plan(
            self.lowered,
            self.cycle_ns,
            tuple(Instant(offset, patterns[events]) for offset, events in instants),
            tuple(self._initial_actions()),
            tuple(end for stage in self.stages for end in stage.every_output),
            self.written,
            self.recorded,
            dict(self._events()),
            tuple(self._tail()),
            (*self.held.values(), *self.rates.notes),
        )

    def _events(self) -> Iterator[tuple[str, tuple[Action, ...]]]:
        """What records a row at an event inside a step of each FMU."""
        read = {end for stage in self.stages for end in stage.every_output}
        own = by_component(end for end in self.recorded if end in read)
        for name, outputs in own.items():
            yield name, (Read(name, outputs, "event"), Record())

    def _tail(self) -> Iterator[Instant]:
        """The end of a run of one FMU whose stop time is no communication point."""
        system = self.system
        length = system.stop_ns - system.start_ns
        (fmu,) = self.lowered.fmus if system.single else (None,)
        if fmu is None or length % fmu.step_ns == 0:
            return
        if not capabilities_of(fmu.policy, self.descriptions[fmu.name]).can_handle_variable_step:
            return
        first = length - length % fmu.step_ns
        yield Instant(first, (Step(fmu.name, length - first),))
        yield Instant(length, (*self._staged(self.stages, {fmu.name: 0}), Record()))

    # order

    def _order_blocks(self) -> list[SampledComponent]:
        names = [c.name for c in self.lowered.sampled if not isinstance(c, DelayComponent)]
        graph = nx.DiGraph()
        graph.add_nodes_from(names)
        ends: dict[tuple[str, str], Wire] = {}
        for wire in self.lowered.wires:
            pair = (wire.source.component, wire.target.component)
            if graph.has_node(pair[0]) and graph.has_node(pair[1]):
                graph.add_edge(*pair)
                ends[pair] = wire
        rank = {name: i for i, name in enumerate(names)}
        try:
            order = list(nx.lexicographical_topological_sort(graph, key=rank.__getitem__))
        except nx.NetworkXUnfeasible:
            loop = [ends[edge[0], edge[1]] for edge in nx.find_cycle(graph)]
            path = ", ".join(f"{wire.source} -> {wire.target}" for wire in loop)
            raise GraphError(
                f"blocks wait for each other at the same instant: {path}; put a delay of one "
                "sample on one of these wires"
            ) from None
        chosen = [self.by_name[name] for name in order]
        return [c for c in chosen if not isinstance(c, FmuComponent)]

    def _fmu_sources(self) -> list[Endpoint]:
        wired = [w.source for w in self.lowered.wires if w.source.component in self.fmus]
        inputs = {wire.target for wire in self.lowered.wires}
        recorded = [end for end in self.recorded if end.component in self.fmus]
        return [*wired, *(end for end in recorded if end not in inputs)]

    def _reading_stages(self, initially: bool = False) -> tuple[tuple[Stage, ...], Feeding]:
        """The stages of an instant, and on what outputs depend in them."""

        def known(wire: Wire) -> bool:
            source = self.by_name[wire.source.component]
            return isinstance(source, (FmuComponent, SignalComponent))

        wires = [w for w in self.lowered.wires if w.target.component in self.fmus and known(w)]
        outputs = self._fmu_sources()
        d = self.descriptions
        feeding: Feeding = partial(feeding_inputs, descriptions=d, initially=initially)
        if self.loops == "hold":
            silent = partial(assumed, descriptions=d, initially=initially)
            held = hold_loops(outputs, wires, feeding, silent)
            self.held |= held.notes
            feeding = held.feeding.__getitem__
        solve = self.loops == "solve"
        return coupling_stages(outputs, wires, feeding, solve=solve, initially=initially), feeding

    def _fresh_stages(self) -> tuple[Stage, ...]:
        """How outputs that depend directly on what blocks have just computed reach other FMUs."""
        wires = [w for w in self.lowered.wires if w.target.component in self.fmus]
        early = {c.name for c in self.lowered.sampled if isinstance(c, SignalComponent)}
        early |= set(self.fmus)
        changed = {w.target for w in wires if w.source.component not in early}
        outputs: dict[Endpoint, None] = {}
        while True:
            found = {
                w.source: None for w in wires
                if w.source.component in self.fmus and w.source not in outputs
                and self.feeding(w.source) & changed
            }  # fmt: skip
            if not found:
                break
            outputs |= found
            changed |= {w.target for w in wires if w.source in found}
        if not outputs:
            return ()
        inner = [w for w in wires if w.source in outputs]
        return coupling_stages(outputs, inner, self.feeding, solve=self.loops == "solve")

    def _written(self) -> tuple[Endpoint, ...]:
        early = [wire.target for stage in self.stages for wire in stage.every_wire]
        every = [w.target for w in self.lowered.wires if w.target.component in self.fmus]
        return tuple(dict.fromkeys([*early, *every]))

    # actions

    def _calendar(self) -> Calendar:
        calendar = Calendar()
        for delay in self.delays:
            taken = range(delay.source_phase_ns, self.cycle_ns, delay.period_ns)
            calendar.enter(Event(Role.ARRIVE, delay.name), self.rates.sample_offsets(delay))
            calendar.enter(Event(Role.TAKE, delay.name), taken)
        for block in self.blocks:
            calendar.enter(Event(Role.SAMPLE, block.name), self.rates.sample_offsets(block))
        calendar.enter(Event(Role.RECORD), range(0, self.cycle_ns, self.system.record_ns))
        for name, grid in self.rates.grid.items():
            for offset, following in zip(grid, [*grid[1:], self.cycle_ns], strict=True):
                calendar.enter(Event(Role.STEP, name, following - offset), [offset])
        return calendar

    def _actions(self, events: tuple[Event, ...]) -> Iterator[Action]:
        names: dict[Role, list[str]] = {role: [] for role in Role}
        for event in events:
            names[event.role].append(event.name)
        due = {event.name: event.step_ns for event in events if event.role is Role.STEP}
        sampled = [self.by_name[name] for name in names[Role.SAMPLE]]
        yield from map(Compute, names[Role.ARRIVE])
        yield from (Sample(c.name) for c in sampled if isinstance(c, SignalComponent))
        yield from self._staged(self.stages, due)
        yield from (Linearise(c.name) for c in sampled if isinstance(c, SensitivityComponent))
        for c in sampled:
            if not isinstance(c, (SignalComponent, SensitivityComponent)):
                yield from self._compute(c)
        yield from self._apply(due)
        for name in names[Role.TAKE]:
            yield Transfer(self.wires_to[name])
        if names[Role.RECORD]:
            yield Record()
        yield from self.algorithm.steps(due)

    def _compute(self, component: Component) -> Iterator[Action]:
        if self.wires_to[component.name]:
            yield Transfer(self.wires_to[component.name])
        yield Compute(component.name)

    def _staged(
        self, stages: tuple[Stage, ...], due: Collection[str], view: View = "present"
    ) -> Iterator[Action]:
        for stage in stages:
            yield from _pass_on([w for w in stage.wires if w.target.component in due], view)
            for loop in stage.loops:
                wires = [w for w in loop.wires if w.target.component in due]
                yield from _pass_on([w for w in wires if w.source.component not in due], view)
                yield from _solve(
                    tuple(w for w in wires if w.source.component in due),
                    _reads((end for end in loop.outputs if end.component in due), view),
                    view,
                )
            yield from _reads((end for end in stage.outputs if end.component in due), view)

    def _apply(self, due: Collection[str]) -> Iterator[Action]:
        wires = tuple(wire for name in due for wire in self.wires_to[name])
        if wires:
            yield Transfer(wires)
        if self.fresh:
            yield from self.algorithm.write(due)
            yield from self._staged(self.fresh, due, "applied")
            outputs = {end for stage in self.fresh for end in stage.every_output}
            moved = tuple(wire for wire in wires if wire.source in outputs)
            yield Transfer(moved, "applied")

    def _initial_actions(self) -> Iterator[Action]:
        yield from self._staged(self.initial_stages, self.fmus)
        stated = {c.name for c in self.system.components}
        for component in sorted(self.lowered.sampled, key=lambda c: c.name in stated):
            if self.wires_to[component.name]:
                yield Transfer(self.wires_to[component.name])
                if component.name not in stated:  # what is on a wire passes its source's value on
                    came_in = Endpoint(component.name, component.inputs[0].name)
                    goes_out = Endpoint(component.name, component.outputs[0].name)
                    yield Transfer((Wire(came_in, goes_out),))
        wires = tuple(wire for name in self.fmus for wire in self.wires_to[name])
        if wires:
            yield Transfer(wires)
            yield from self.algorithm.write(self.fmus)
        yield from self.algorithm.begin()


def _pass_on(wires: Collection[Wire], view: View) -> Iterator[Action]:
    if wires:
        yield Transfer(tuple(wires), view)
        yield from _writes(wires)


def _writes(wires: Iterable[Wire]) -> Iterator[Write]:
    targets = by_component(wire.target for wire in wires)
    return (Write(name, inputs) for name, inputs in targets.items())


def _reads(ends: Iterable[Endpoint], view: View) -> Iterator[Read]:
    return (Read(name, outputs, view) for name, outputs in by_component(ends).items())


def _solve(wires: tuple[Wire, ...], reads: Iterator[Read], view: View) -> Iterator[Action]:
    """The reads of an algebraic loop, repeated until they agree with what goes along `wires`."""
    if wires:
        yield Iterate(wires, view, (*_writes(wires), *reads))
    else:
        yield from reads
