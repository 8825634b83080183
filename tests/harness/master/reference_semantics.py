"""The timing contract by brute force: a `System` simulated from its text, without any plan.

Time is an integer; every instant at which anything happens is a member of one sorted set, and at
each of them the five parts of the contract follow one another. Values are found by asking, as in
"what does this input read now?", never by an order worked out beforehand.
"""

from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.instruments.source import named_seed
from harness.system.check import inputs_of, outputs_of
from harness.system.graph import (
    BlockComponent,
    Connection,
    Endpoint,
    FmuComponent,
    SignalComponent,
    System,
)
from harness.system.units import conversion
from tests.harness.master.mock import MockFmu, Model


@dataclass
class Line:
    """A delay: (arrival, value) of what is under way, and the value that is held."""

    held: float
    under_way: deque[tuple[int, float]]


class Simulation:
    """Rows of `recorded` of a system whose FMUs are mocks."""

    def __init__(
        self, system: System, fmus: Mapping[str, MockFmu], recorded: tuple[Endpoint, ...]
    ) -> None:
        self.system, self.recorded = system, recorded
        self.models: dict[str, Model] = {name: fmu.model() for name, fmu in fmus.items()}
        self.descriptions = {name: fmu.description for name, fmu in fmus.items()}
        self.components = {c.name: c for c in system.components}
        self.wire_to = {wire.target: wire for wire in system.connections}
        self.value: dict[Endpoint, float] = {}  # outputs, as last read or computed
        self.applied: dict[Endpoint, float] = {}  # FMU outputs with the inputs just applied
        self.reached: dict[Endpoint, float] = {}  # FMU outputs at the end of the step
        self.input: dict[Endpoint, float] = {}
        self.states = {
            c.name: (c.block.parameters.copy(), c.block.state.copy())
            for c in system.components
            if isinstance(c, BlockComponent)
        }
        self.lines: dict[Endpoint, Line] = {}
        self.conversions = {wire: self.conversion(wire) for wire in system.connections}
        self.signals = {
            c.name: c.source.sampler(named_seed(system.seed, c.name))
            for c in system.components
            if isinstance(c, SignalComponent)
        }

    def conversion(self, wire: Connection) -> tuple[float, float]:
        d = self.descriptions
        source = outputs_of(self.components[wire.source.component], d)[wire.source.variable]
        target = inputs_of(self.components[wire.target.component], d)[wire.target.variable]
        return conversion(source.unit, target.unit)

    # when

    def due(self, name: str, now: int) -> bool:
        """Whether `now` is one of the instants `phase + k * period` of a component."""
        c = self.components[name]
        if isinstance(c, FmuComponent):
            return (now - self.system.start_ns) % c.step_ns == 0
        since = now - self.system.start_ns - c.phase_ns
        return since >= 0 and since % c.period_ns == 0

    def arrives(self, wire: Connection, now: int) -> bool:
        """Whether a value (be it one from before the start) arrives over a delayed wire."""
        c = self.components[wire.source.component]
        period = c.step_ns if isinstance(c, FmuComponent) else c.period_ns
        phase = 0 if isinstance(c, FmuComponent) else c.phase_ns
        return (now - self.system.start_ns - phase - wire.delay_ns) % period == 0

    def stands(self, name: str, now: int) -> bool:
        """Whether FMU `name` is at a communication point: its step, or an arrival at its input."""
        return self.due(name, now) or any(
            wire.delay_ns and wire.target.component == name and self.arrives(wire, now)
            for wire in self.system.connections
        )

    def instants(self) -> list[int]:
        s = self.system
        grids = {(s.start_ns, s.record_ns)}
        for c in s.components:
            if isinstance(c, FmuComponent):
                grids.add((s.start_ns, c.step_ns))
            else:
                grids.add((s.start_ns + c.phase_ns, c.period_ns))
        for wire in s.connections:
            if wire.delay_ns:
                c = self.components[wire.source.component]
                period = c.step_ns if isinstance(c, FmuComponent) else c.period_ns
                phase = 0 if isinstance(c, FmuComponent) else c.phase_ns
                grids.add((s.start_ns + (phase + wire.delay_ns) % period, period))
        return sorted({t for first, step in grids for t in range(first, s.stop_ns + 1, step)})

    # what

    def fmus(self, now: int | None = None) -> list[FmuComponent]:
        return [
            c for c in self.system.fmus if now is None or self.stands(c.name, now)
        ]  # in the order of the system, which Gauss–Seidel follows

    def read(self, end: Endpoint, now: int, known: Mapping[Endpoint, float] | None) -> float:
        """An FMU output; inputs on which it depends are set first, to what is known of them.

        `known` None: from signals and FMUs only (before the blocks compute); else from all.
        """
        port = next(p for p in self.models[end.component].outputs if p.name == end.variable)
        for name in port.depends:
            target = Endpoint(end.component, name)
            wire = self.wire_to.get(target)
            if wire is None:
                continue
            early = not wire.delay_ns and isinstance(
                self.components[wire.source.component], (FmuComponent, SignalComponent)
            )
            if known is not None or early:
                self.apply(target, self.incoming(wire, now, known))
        return self.models[end.component].get(end.variable)

    def incoming(self, wire: Connection, now: int, known: Mapping[Endpoint, float] | None) -> float:
        """What a wire brings to an FMU input at `now`."""
        factor, offset = self.conversions[wire]
        if wire.delay_ns:
            return factor * self.lines[wire.target].held + offset
        source = wire.source
        if isinstance(self.components[source.component], FmuComponent):
            if self.stands(source.component, now):
                value = self.read(source, now, known)
            else:
                value = (self.value if known is None else self.applied)[source]
            return factor * value + offset
        return factor * self.value[source] + offset

    def apply(self, target: Endpoint, value: float) -> None:
        self.models[target.component].set(target.variable, value)
        self.input[target] = self.models[target.component].values[target.variable]

    def compute(self, c: Any, now: int, done: set[str]) -> None:
        """A block that is due, after those that it reads from."""
        if c.name in done or not self.due(c.name, now):
            return
        done.add(c.name)
        if isinstance(c, SignalComponent):
            value = self.signals[c.name].sample(np.array([now], dtype=np.int64))[0]
            self.value[Endpoint(c.name, "value")] = float(value)
            return
        u = []
        for port in c.inputs:
            wire = self.wire_to[Endpoint(c.name, port.name)]
            factor, offset = self.conversions[wire]
            source = self.components[wire.source.component]
            if wire.delay_ns:
                value = self.lines[wire.target].held
            else:
                if not isinstance(source, FmuComponent):
                    self.compute(source, now, done)
                value = self.value[wire.source]
            u.append(factor * value + offset)
            self.input[wire.target] = u[-1]
        if isinstance(c, BlockComponent):
            y = np.zeros(len(c.outputs))
            c.block.step(*self.states[c.name], np.array(u), y)
            results = y.tolist()
        else:
            given = c.function(now / 10**9, *u)
            results = [given] if isinstance(given, float) else given
        for port, value in zip(c.outputs, results, strict=True):
            self.value[Endpoint(c.name, port.name)] = value

    def wires_into_fmus(self, now: int | None = None) -> Iterator[Connection]:
        names = {c.name for c in self.fmus(now)}
        return (wire for wire in self.system.connections if wire.target.component in names)

    # the contract

    def initialise(self) -> None:
        start = self.system.start_ns
        for c in self.system.components:
            if isinstance(c, SignalComponent):
                sampler = c.source.sampler(named_seed(self.system.seed, c.name))
                first = np.array([start + c.phase_ns], dtype=np.int64)
                self.value[Endpoint(c.name, "value")] = float(sampler.sample(first)[0])
            elif not isinstance(c, FmuComponent):
                for port in c.outputs:
                    self.value[Endpoint(c.name, port.name)] = port.start
        self.read_all(start)
        self.applied = dict(self.value)
        for wire in self.system.connections:
            if wire.delay_ns:
                self.lines[wire.target] = Line(self.value[wire.source], deque())
        for wire in self.wires_into_fmus():
            factor, offset = self.conversions[wire]
            held = self.lines[wire.target].held if wire.delay_ns else self.value[wire.source]
            self.apply(wire.target, factor * held + offset)
        for c in self.system.components:
            if not isinstance(c, FmuComponent):
                for port in c.inputs:
                    end = Endpoint(c.name, port.name)
                    wire = self.wire_to[end]
                    factor, offset = self.conversions[wire]
                    self.input[end] = factor * self.value[wire.source] + offset

    def read_all(self, now: int) -> None:
        for c in self.fmus(now):
            for port in self.models[c.name].outputs:
                end = Endpoint(c.name, port.name)
                self.value[end] = self.read(end, now, None)

    def run(self) -> tuple[list[int], list[list[float]], bool]:
        """Times and rows, and whether a number did not fit its port and ended the run."""
        times: list[int] = []
        rows: list[list[float]] = []
        try:
            self.initialise()
            self.proceed(times, rows)
        except OverflowError:
            return times, rows, True
        return times, rows, False

    def proceed(self, times: list[int], rows: list[list[float]]) -> None:
        instants = self.instants()
        for place, now in enumerate(instants):
            for line in self.lines.values():
                while line.under_way and line.under_way[0][0] <= now:
                    arrival, line.held = line.under_way.popleft()
                    assert arrival == now, "a value arrived between instants"
            done: set[str] = set()
            for c in self.system.components:
                if isinstance(c, SignalComponent):
                    self.compute(c, now, done)
            self.read_all(now)
            for c in self.system.components:
                if not isinstance(c, FmuComponent):
                    self.compute(c, now, done)
            self.apply_all(now)
            for wire in self.system.connections:
                if wire.delay_ns and self.due(wire.source.component, now):
                    line = self.lines[wire.target]
                    line.under_way.append((now + wire.delay_ns, self.value[wire.source]))
            if (now - self.system.start_ns) % self.system.record_ns == 0:
                times.append(now)
                rows.append([self.look(end) for end in self.recorded])
            self.step(now, instants[place + 1 :])

    def look(self, end: Endpoint) -> float:
        return self.value[end] if end in self.value else self.input[end]

    def apply_all(self, now: int) -> None:
        fresh: dict[Endpoint, float] = {}
        for wire in list(self.wires_into_fmus(now)):
            self.apply(wire.target, self.incoming(wire, now, fresh))
        for c in self.fmus(now):
            for port in self.models[c.name].outputs:
                end = Endpoint(c.name, port.name)
                self.applied[end] = self.models[c.name].get(port.name)

    def step(self, now: int, later: list[int]) -> None:
        earlier: set[str] = set()
        sequential = self.system.algorithm == "gauss-seidel"
        for c in self.system.fmus:
            if self.stands(c.name, now):
                for wire in self.system.connections if sequential else ():
                    ends = wire.target.component == c.name and wire.source.component in earlier
                    if ends and not wire.delay_ns:
                        factor, offset = self.conversions[wire]
                        self.apply(wire.target, factor * self.reached[wire.source] + offset)
                following = next((t for t in later if self.stands(c.name, t)), None)
                if following is not None:
                    self.models[c.name].step(now / 10**9, (following - now) / 10**9)
                for port in self.models[c.name].outputs:
                    end = Endpoint(c.name, port.name)
                    self.reached[end] = self.models[c.name].get(port.name)
            earlier.add(c.name)
