"""The planner: from a lowered system to a schedule of actions that repeats every cycle.

At each instant, in this order (the timing contract):

    0  delay lines whose value arrives now
    1  signals are sampled, FMU outputs are read, sensitivities computed
    2  blocks that are due compute, in the order of their wires
    3  what they computed goes to the FMU inputs and into delay lines, a row is recorded
    4  FMUs step to their next instant

The algorithms by which FMUs are coupled differ in part 4 only, which is `master`'s.

It refuses rates that do not divide one another, loops of blocks without delay, loops of direct
feedthrough unless they are to be solved, and cycles that would need more than `MAX_ACTIONS`
actions.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import networkx as nx

from harness.clock import common_cycle, show
from harness.errors import GraphError, TimingError
from harness.execution.actions import (
    Action,
    Compute,
    Instant,
    Iterate,
    Linearise,
    Read,
    Record,
    Sample,
    Transfer,
    View,
    Write,
)
from harness.execution.calendar import Calendar, Event, Role
from harness.execution.coupling import Feeding, Stage, coupling_stages, feeding_inputs
from harness.execution.master import Master, by_component, strong_groups
from harness.fmi.model_description import ModelDescription
from harness.system.graph import (
    Component,
    Endpoint,
    FmuComponent,
    SampledComponent,
    SensitivityComponent,
    SignalComponent,
)
from harness.system.lowering import DelayComponent, LoweredSystem, Wire, rate_of

MAX_ACTIONS = 1_000_000


@dataclass(frozen=True)
class Plan:
    """The schedule of one cycle, and what initialises a run.

    Instants at which the same things are due share one tuple of actions. `initial` propagates
    values once, before the first cycle; `read` and `written` are the FMU
    ports that the plan touches, each in the order in which they should lie in memory; `recorded`
    are the columns of a row.
    """

    lowered: LoweredSystem
    cycle_ns: int
    instants: tuple[Instant, ...]
    initial: tuple[Action, ...]
    read: tuple[Endpoint, ...]
    written: tuple[Endpoint, ...]
    recorded: tuple[Endpoint, ...]

    @property
    def patterns(self) -> tuple[tuple[Action, ...], ...]:
        """The distinct lists of actions of all instants."""
        return tuple({id(instant.actions): instant.actions for instant in self.instants}.values())


def make_plan(
    lowered: LoweredSystem,
    descriptions: Mapping[str, ModelDescription],
    recorded: tuple[Endpoint, ...],
) -> Plan:
    """Plan a checked and lowered system; raises `GraphError` or `TimingError`."""
    return _Planner(lowered, descriptions, recorded).plan()


class _Planner:
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
        self.by_name: dict[str, Component] = {c.name: c for c in lowered.components}
        self.wires_to: dict[str, list[Wire]] = {name: [] for name in self.by_name}
        for wire in lowered.wires:
            self.wires_to[wire.target.component].append(wire)
        self.delays = [c for c in lowered.sampled if isinstance(c, DelayComponent)]
        self._check_phases()
        self._check_rates()
        periods = [rate_of(c).period_ns for c in lowered.components]
        self.cycle_ns = common_cycle([*periods, self.system.record_ns])
        self._check_size()
        self.grid = {name: self._communication_offsets(c) for name, c in self.fmus.items()}
        self._check_stop()
        self._join_grids()
        self.blocks = self._order_blocks()
        self.stages = self._reading_stages(partial(feeding_inputs, descriptions=descriptions))
        self.initial_stages = self._reading_stages(
            partial(feeding_inputs, descriptions=descriptions, initially=True)
        )
        self.fresh = self._fresh_stages()
        self.written = self._written()
        self.written_of = by_component(self.written)
        self.master = Master(lowered, descriptions, self.grid, self.written_of)

    def plan(self) -> Plan:
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
        )

    # rates

    def _check_phases(self) -> None:
        for c in self.lowered.sampled:
            rate = rate_of(c)
            if rate.phase_ns < 0:
                raise TimingError(f"{c.name}: phase {show(rate.phase_ns)} is negative")
            if rate.phase_ns >= rate.period_ns:
                raise TimingError(
                    f"{c.name}: phase {show(rate.phase_ns)} is not below its period "
                    f"{show(rate.period_ns)}"
                )

    def _check_rates(self) -> None:
        for c in self.lowered.sampled:
            if isinstance(c, SensitivityComponent):
                step_ns = self.fmus[c.component].step_ns
                if c.period_ns % step_ns or c.phase_ns % step_ns:
                    raise TimingError(
                        f"sensitivity {c.name} runs every {show(c.period_ns)} (first at "
                        f"{show(c.phase_ns)}) but {c.component} steps by {show(step_ns)}: both "
                        "must be whole multiples of it"
                    )
        for wire in self.lowered.wires:
            source, target = (self.by_name[e.component] for e in (wire.source, wire.target))
            fmu = next((c for c in (source, target) if isinstance(c, FmuComponent)), None)
            other = target if fmu is source else source
            if fmu is None or isinstance(other, DelayComponent):
                continue
            rate = rate_of(other)
            fast, slow = sorted((fmu.step_ns, rate.period_ns))
            if slow % fast or (fast == fmu.step_ns and rate.phase_ns % fast):
                offset = f" (first at {show(rate.phase_ns)})" if rate.phase_ns else ""
                raise TimingError(
                    f"{other.name} runs every {show(rate.period_ns)}{offset} but {fmu.name} steps "
                    f"by {show(fmu.step_ns)}: one must be a whole multiple of the other"
                )

    def _join_grids(self) -> None:
        """FMUs that repeat their steps together communicate at the same instants."""
        for group in strong_groups(self.lowered) if self.system.algorithm == "iterative" else ():
            steps = {self.fmus[name].step_ns for name in group}
            if len(steps) > 1:
                text = ", ".join(f"{name} {show(self.fmus[name].step_ns)}" for name in group)
                raise TimingError(
                    f"the iterative algorithm repeats the steps of FMUs that drive each other "
                    f"together, so their steps must be equal: {text}"
                )
            joined = tuple(sorted({offset for name in group for offset in self.grid[name]}))
            for name in group:
                capabilities = self.descriptions[name].co_simulation
                fixed = capabilities is not None and not capabilities.can_handle_variable_step
                if fixed and self.grid[name] != joined:
                    raise TimingError(
                        f"a delayed value arrives between the steps of FMUs that step together "
                        f"with {name}, whose FMU takes steps of {show(*steps)} only; use a delay "
                        "that is a multiple of it"
                    )
                self.grid[name] = joined

    def _communication_offsets(self, fmu: FmuComponent) -> tuple[int, ...]:
        offsets = set(range(0, self.cycle_ns, fmu.step_ns))
        capabilities = self.descriptions[fmu.name].co_simulation
        for wire in self.wires_to[fmu.name]:
            source = self.by_name[wire.source.component]
            if not isinstance(source, DelayComponent):
                continue
            arrivals = set(self._sample_offsets(source))
            fixed = capabilities is not None and not capabilities.can_handle_variable_step
            if fixed and arrivals - set(range(0, self.cycle_ns, fmu.step_ns)):
                raise TimingError(
                    f"{wire.source} arrives between the steps of {fmu.name}, whose FMU takes steps "
                    f"of {show(fmu.step_ns)} only; use a delay that is a multiple of it"
                )
            offsets |= arrivals
        return tuple(sorted(offsets))

    def _sample_offsets(self, component: SampledComponent) -> range:
        rate = rate_of(component)
        return range(rate.phase_ns, self.cycle_ns, rate.period_ns)

    def _check_size(self) -> None:
        rates = {c.name: rate_of(c).period_ns for c in self.lowered.components}
        count = sum(self.cycle_ns // period for period in rates.values())
        if count > MAX_ACTIONS:
            text = ", ".join(f"{name} {show(period)}" for name, period in sorted(rates.items())[:8])
            raise TimingError(
                f"the rates share no cycle shorter than {show(self.cycle_ns)}, which would take "
                f"{count} actions (at most {MAX_ACTIONS}); choose rates that divide one another: "
                f"{text}"
            )

    def _check_stop(self) -> None:
        length = self.system.stop_ns - self.system.start_ns
        for fmu in self.fmus.values():
            if length % fmu.step_ns:
                raise TimingError(
                    f"{fmu.name} steps by {show(fmu.step_ns)}, which does not divide the run of "
                    f"{show(length)}; the nearest stop time is "
                    f"{show(self.system.start_ns + round(length / fmu.step_ns) * fmu.step_ns)}"
                )

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

    def _reading_stages(self, feeding: Feeding) -> tuple[Stage, ...]:
        def known(wire: Wire) -> bool:
            source = self.by_name[wire.source.component]
            return isinstance(source, (FmuComponent, SignalComponent))

        wires = [w for w in self.lowered.wires if w.target.component in self.fmus and known(w)]
        solve = self.system.solves_loops
        return coupling_stages(self._fmu_sources(), wires, feeding, solve=solve)

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
                and feeding_inputs(w.source, self.descriptions) & changed
            }  # fmt: skip
            if not found:
                break
            outputs |= found
            changed |= {w.target for w in wires if w.source in found}
        if not outputs:
            return ()
        inner = [w for w in wires if w.source in outputs]
        feeding = partial(feeding_inputs, descriptions=self.descriptions)
        return coupling_stages(outputs, inner, feeding, solve=self.system.solves_loops)

    def _written(self) -> tuple[Endpoint, ...]:
        early = [wire.target for stage in self.stages for wire in stage.every_wire]
        every = [w.target for w in self.lowered.wires if w.target.component in self.fmus]
        return tuple(dict.fromkeys([*early, *every]))

    # actions

    def _calendar(self) -> Calendar:
        calendar = Calendar(self.cycle_ns)
        for delay in self.delays:
            taken = range(delay.source_phase_ns, self.cycle_ns, delay.period_ns)
            calendar.enter(Event(Role.ARRIVE, delay.name), self._sample_offsets(delay))
            calendar.enter(Event(Role.TAKE, delay.name), taken)
        for block in self.blocks:
            calendar.enter(Event(Role.SAMPLE, block.name), self._sample_offsets(block))
        calendar.enter(Event(Role.RECORD), range(0, self.cycle_ns, self.system.record_ns))
        for name, grid in self.grid.items():
            calendar.enter_steps(name, grid)
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
            yield Transfer(tuple(self.wires_to[name]))
        if names[Role.RECORD]:
            yield Record()
        yield from self.master.steps(due)

    def _compute(self, component: Component) -> Iterator[Action]:
        if self.wires_to[component.name]:
            yield Transfer(tuple(self.wires_to[component.name]))
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
            yield from self._write(due)
            yield from self._staged(self.fresh, due, "applied")
            outputs = {end for stage in self.fresh for end in stage.every_output}
            moved = tuple(wire for wire in wires if wire.source in outputs)
            yield Transfer(moved, "applied")

    def _write(self, due: Iterable[str]) -> Iterator[Action]:
        yield from (Write(name, self.written_of[name]) for name in due if name in self.written_of)

    def _initial_actions(self) -> Iterator[Action]:
        yield from self._staged(self.initial_stages, self.fmus)
        stated = {c.name for c in self.system.components}
        for component in sorted(self.lowered.sampled, key=lambda c: c.name in stated):
            if self.wires_to[component.name]:
                yield Transfer(tuple(self.wires_to[component.name]))
                if component.name not in stated:  # what is on a wire passes its source's value on
                    came_in = Endpoint(component.name, component.inputs[0].name)
                    goes_out = Endpoint(component.name, component.outputs[0].name)
                    yield Transfer((Wire(came_in, goes_out),))
        wires = tuple(wire for name in self.fmus for wire in self.wires_to[name])
        if wires:
            yield Transfer(wires)
            yield from self._write(self.fmus)
        yield from self.master.begin()


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
