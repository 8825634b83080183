"""The linker: from a plan and live participants to the arrays that the loop executes.

All memory to which the program holds addresses belongs to the `Program` and lives as long as it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.clock import to_seconds
from harness.compiler import operations as op
from harness.fmi.description.model_description import INTEGER_TYPES, ModelDescription
from harness.master.plan.actions import (
    Action,
    Blend,
    Compute,
    Instant,
    Iterate,
    Keep,
    Linearise,
    Read,
    Record,
    Restore,
    Sample,
    Save,
    Slope,
    Step,
    Transfer,
    UnlessStop,
    Write,
    flat,
)
from harness.master.plan.planner import Plan
from harness.master.program.copying import keep, transfer, weigh
from harness.master.program.iteration import Iteration
from harness.master.program.layout import Layout, make_layout, whole
from harness.master.program.start_values import start_values
from harness.participants.block import BlockParticipant
from harness.participants.fmu import FmuParticipant
from harness.participants.memory import Cell, Memory, Row
from harness.participants.participant import Participant
from harness.system.graph import Endpoint, SignalComponent

_LARGEST_CELL = 8  # bytes of a C number, for each port that is read or written


@dataclass
class Program:
    """A linked plan: what `loop.run_cycles` takes, and whose operation each row is.

    `initial` is the one instant that propagates values during initialisation, `instants` are
    those of a cycle, `tail` those after the last one; instants that share their actions share their
    rows. `events` has, by name of an FMU, the instant that records a row at one of its events, and
    the slots of that row. `owners[i]` is the action
    behind row i of `code`.
    """

    plan: Plan
    layout: Layout
    memory: Memory
    participants: Mapping[str, Participant]
    recorded: NDArray[np.int64]
    code: NDArray[np.int64] = field(init=False)
    instants: NDArray[np.int64] = field(init=False)
    initial: NDArray[np.int64] = field(init=False)
    tail: NDArray[np.int64] = field(init=False)
    events: dict[str, tuple[NDArray[np.int64], NDArray[np.int64]]] = field(default_factory=dict)
    copies: NDArray[np.int64] = field(init=False)
    scales: NDArray[np.float64] = field(init=False)
    owners: list[Action] = field(default_factory=list)
    signals: list[SignalComponent] = field(default_factory=list)
    iterations: dict[Iterate, Iteration] = field(default_factory=dict)

    @property
    def v(self) -> NDArray[np.float64]:
        """Every signal of the system, float64 (n_slots,)."""
        return self.memory.v

    @property
    def clock(self) -> NDArray[np.int64]:
        """The loop's own state."""
        return self.memory.clock

    @property
    def fmus(self) -> dict[str, FmuParticipant]:
        """The participants that are FMUs."""
        return {n: p for n, p in self.participants.items() if isinstance(p, FmuParticipant)}

    @property
    def states(self) -> dict[str, NDArray[np.float64]]:
        """The live states of the blocks by name."""
        blocks = self.participants.items()
        return {n: p.state for n, p in blocks if isinstance(p, BlockParticipant)}


def link(
    plan: Plan,
    participants: Mapping[str, Participant],
    descriptions: Mapping[str, ModelDescription],
    clock: NDArray[np.int64],
) -> Program:
    """Bind `plan` to live participants; raises `FmuError` or `CompileError`.

    The loop keeps its state in the array `clock`.
    """
    return _Linker(plan, participants, descriptions, clock).link()


class _Linker:
    def __init__(
        self,
        plan: Plan,
        participants: Mapping[str, Participant],
        descriptions: Mapping[str, ModelDescription],
        clock: NDArray[np.int64],
    ) -> None:
        self.plan, self.participants, self.descriptions = plan, participants, descriptions
        self.layout = make_layout(plan, descriptions)
        distinct = set(flat(plan.actions))
        room = sum(map(self._ports, distinct))
        solving = sum(1 + 2 * len(a.wires) for a in distinct if isinstance(a, (Iterate, Slope)))
        slots = self.layout.size + solving + sum(map(self._negated, distinct))
        self.memory = Memory(
            slots, _LARGEST_CELL * (1 + room), clock, self.layout.slot, self.layout.cell
        )
        self.memory.scratch(self.layout.size)
        recorded = [self.layout.slots[end] for end in plan.recorded]
        self.program = Program(
            plan, self.layout, self.memory, participants, np.array(recorded, dtype=np.int64)
        )
        self.shared: dict[Action, list[tuple[Row, Action]]] = {}

    def link(self) -> Program:
        program = self.program
        for participant in self.participants.values():
            participant.link(self.memory, self.participants)
        for component in self.plan.lowered.sampled:
            if isinstance(component, SignalComponent):
                program.signals.append(component)
        for end, value in start_values(self.plan, self.descriptions).items():
            self.memory.store(end, _fitting(value, self.layout.cell(end)))
        rows: list[Row] = []
        spans: dict[int, tuple[int, int]] = {}
        plan = self.plan
        tail = [instant.actions for instant in plan.tail]
        for actions in (plan.initial, *plan.patterns, *plan.events.values(), *tail):
            first = len(rows)
            for action in actions:
                for row, owner in self.operations(action):
                    rows.append(row)
                    program.owners.append(owner)
            spans[id(actions)] = (first, len(rows))
        program.code = np.zeros((len(rows), op.WIDTH), dtype=np.int64)
        for i, row in enumerate(rows):
            program.code[i, : len(row)] = row

        def table(instants: Iterable[Instant]) -> NDArray[np.int64]:
            found = [(instant.offset_ns, *spans[id(instant.actions)]) for instant in instants]
            return np.array(found, dtype=np.int64).reshape(-1, 3)

        program.initial = table([Instant(0, plan.initial)])
        program.instants, program.tail = table(plan.instants), table(plan.tail)
        for name, actions in plan.events.items():
            read = {e for a in actions if isinstance(a, Read) for e in self._read(a)}
            slots = [
                self.layout.slot(end, "event" if end in read else "present")
                for end in plan.recorded
            ]
            columns = np.array(slots, dtype=np.int64)
            program.events[name] = table([Instant(0, actions)]), columns
        program.copies, program.scales = self.memory.copies
        return program

    def operations(self, action: Action) -> list[tuple[Row, Action]]:
        """The rows of an action and whose they are; equal actions share one set of memory."""
        if action not in self.shared:
            if isinstance(action, Iterate):
                self.shared[action] = list(self._iterate(action))
            else:
                self.shared[action] = [(row, action) for row in self._operations(action)]
        return self.shared[action]

    def _operations(self, action: Action) -> Iterable[Row]:
        match action:
            case Transfer():
                return transfer(self.memory, self.layout, action, self._stored)
            case Blend():
                return weigh(self.memory, self.layout, action)
            case Keep():
                return [keep(self.memory, self.layout, action)]
            case Record():
                return [[op.RECORD]]
            case UnlessStop():
                return [[op.UNLESS_STOP]]
            case Iterate():
                raise AssertionError("an iteration has rows of several actions")
        mover = self.participants[action.component]
        match action:
            case Sample() | Compute() | Linearise():
                return mover.compute()
            case Read():
                return mover.read(action.outputs, action.view)
            case Write():
                return mover.write(action.inputs)
            case Step():
                return mover.step(action.step_ns, action.final)
            case Save():
                return mover.save()
            case Restore():
                return mover.restore()
            case Slope():
                return self._slope(mover, action)

    def _slope(self, mover: Participant, action: Slope) -> Iterator[Row]:
        slots = self.memory.scratch(len(action.wires))
        per_second = 1.0 / to_seconds(action.step_ns)
        yield from weigh(self.memory, self.layout, action, slots, per_second)
        yield from mover.slopes([wire.target.variable for wire in action.wires], slots)

    def _iterate(self, action: Iterate) -> Iterator[tuple[Row, Action]]:
        memory, layout = self.memory, self.layout
        system, n = self.plan.lowered.system, len(action.wires)
        first = memory.scratch(1 + 2 * n)[0]
        iteration = Iteration(action, system, self.descriptions, first)
        self.program.iterations[action] = iteration
        inputs = [layout.slots[wire.target] for wire in action.wires]
        outputs = [layout.slot(wire.source, action.view) for wire in action.wires]
        scales = [(wire.factor, wire.offset) for wire in action.wires]
        yield memory.copy(inputs, iteration.assumed), action
        yield memory.copy(iteration.assumed, inputs), action
        body = [pair for inner in action.body for pair in self.operations(inner)]
        yield from body
        yield memory.copy(outputs, iteration.found, scales), action
        yield iteration.solve(memory.address(0)), action
        yield [op.REPEAT, iteration.first, len(body) + 3], action

    def _stored(self, end: Endpoint) -> int:
        """How an FMU's input holds a real: rows show what it was given."""
        d = self.descriptions.get(end.component)
        if d is None:
            return op.EXACT
        kind = d.port(end.variable).type
        if kind in INTEGER_TYPES:
            return op.ROUND
        return {"Boolean": op.TRUTH, "Float32": op.SINGLE}.get(kind, op.EXACT)

    def _read(self, action: Read) -> list[Endpoint]:
        return [Endpoint(action.component, name) for name in action.outputs]

    def _ports(self, action: Action) -> int:
        """Room that an action may need in the exchange buffer, in cells."""
        match action:
            case Read(name, variables) | Write(name, variables):
                return len(whole((Endpoint(name, v) for v in variables), self.descriptions))
            case Step():
                return 1
        return 0

    def _negated(self, action: Action) -> int:
        """Slots that an action may need beside those of the ports."""
        if not isinstance(action, Write):
            return 0
        d = self.descriptions[action.component]
        return sum(d.port(name).details.negated for name in action.inputs)


def _fitting(value: Any, cell: Cell) -> Any:
    """A start value as its slot holds it: texts are empty where none is stated."""
    empty = {"text": "", "binary": b""}.get(cell)
    if empty is not None:
        return value if isinstance(value, type(empty)) else empty
    return value if cell == "real" or isinstance(value, int) else int(value)
