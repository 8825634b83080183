"""The linker: from a plan and live participants to the arrays that the loop executes.

All memory to which the program holds addresses belongs to the `Program` and lives as long as it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.clock import to_seconds
from harness.compiler import operations as op
from harness.fmi.description.model_description import INTEGER_TYPES
from harness.master.plan.actions import (
    Action,
    Blend,
    Instant,
    Iterate,
    Keep,
    ParticipantAction,
    Read,
    Record,
    Slope,
    Transfer,
    UnlessStop,
    Write,
    flat,
)
from harness.master.plan.planner import Plan
from harness.master.program.copying import keep, transfer, weigh
from harness.master.program.iteration import Iteration
from harness.master.program.layout import make_layout
from harness.master.program.shortcuts import shorten
from harness.master.program.start_values import start_values
from harness.participants.access import scalar_ports
from harness.participants.block import BlockParticipant
from harness.participants.fmu import FmuParticipant
from harness.participants.memory import Cell, Memory, Row
from harness.participants.participant import Participant
from harness.system.graph import Descriptions, Endpoint, SignalComponent

_LARGEST_CELL = 8  # bytes of a C number, for each port that is read or written


@dataclass(frozen=True, eq=False)
class Program:
    """A linked plan: what `loop.run_cycles` takes, and whose operation each row is.

    `initial` is the one instant that propagates values during initialisation, `instants` are
    those of a cycle, `tail` those after the last one; instants that share their actions share their
    rows. `events` has, by name of an FMU, the instant that records a row at one of its events, and
    the slots of that row. `owners[i]` is the action behind row i of `code`.
    """

    plan: Plan
    memory: Memory
    participants: Mapping[str, Participant]
    code: NDArray[np.int64]
    owners: Sequence[Action]
    recorded: NDArray[np.int64]
    initial: NDArray[np.int64]
    instants: NDArray[np.int64]
    tail: NDArray[np.int64]
    events: Mapping[str, tuple[NDArray[np.int64], NDArray[np.int64]]]
    copies: NDArray[np.int64]
    scales: NDArray[np.float64]
    iterations: Mapping[Iterate, Iteration]

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
    def signals(self) -> list[SignalComponent]:
        """The signals, in the order of their numbers."""
        return [c for c in self.plan.lowered.sampled if isinstance(c, SignalComponent)]

    @property
    def states(self) -> dict[str, NDArray[np.float64]]:
        """The live states of the blocks by name."""
        blocks = self.participants.items()
        return {n: p.state for n, p in blocks if isinstance(p, BlockParticipant)}


class Linker:
    """Binds `plan` to live participants; the loop keeps its state in the array `clock`."""

    def __init__(
        self,
        plan: Plan,
        participants: Mapping[str, Participant],
        descriptions: Descriptions,
        clock: NDArray[np.int64],
    ) -> None:
        self.plan, self.participants, self.descriptions = plan, participants, descriptions
        distinct = set(flat(plan.actions))
        room = sum(map(self._ports, distinct))
        solving = sum(1 + 2 * len(a.wires) for a in distinct if isinstance(a, (Iterate, Slope)))
        self.memory = Memory(
            make_layout(plan, descriptions), clock, solving + sum(map(self._negated, distinct)),
            _LARGEST_CELL * (1 + room),
        )  # fmt: skip
        self.iterations: dict[Iterate, Iteration] = {}
        self.shared: dict[Action, list[tuple[Row, Action]]] = {}

    def link(self) -> Program:
        """The program; raises `FmuError` or `CompileError`."""
        plan, memory = self.plan, self.memory
        for participant in self.participants.values():
            participant.link(memory, self.participants)
        for port, value in start_values(plan, self.descriptions).items():
            memory.store(port, _fitting(value, memory.cell(port)))
        rows: list[tuple[Row, Action]] = []
        spans: dict[int, tuple[int, int]] = {}
        tail = [instant.actions for instant in plan.tail]
        for actions in (plan.initial, *plan.patterns, *plan.events.values(), *tail):
            first = len(rows)
            for action in actions:
                rows += self.operations(action)
            spans[id(actions)] = (first, len(rows))
        code = np.zeros((len(rows), op.WIDTH), dtype=np.int64)
        for i, (row, _) in enumerate(rows):
            code[i, : len(row)] = row
        copies, scales = memory.copies
        for begin, end in spans.values():
            shorten(memory, code[begin:end], copies)

        def table(instants: Iterable[Instant]) -> NDArray[np.int64]:
            found = [(instant.offset_ns, *spans[id(instant.actions)], 0) for instant in instants]
            return np.array(found, dtype=np.int64).reshape(-1, op.INSTANT_WIDTH)

        events = {
            name: (table([Instant(0, actions)]), self._row_slots(actions))
            for name, actions in plan.events.items()
        }
        return Program(
            plan, memory, self.participants, code, [owner for _, owner in rows],
            self._row_slots(()), table([Instant(0, plan.initial)]), table(plan.instants),
            table(plan.tail), events, copies, scales, self.iterations,
        )  # fmt: skip

    def _row_slots(self, actions: Iterable[Action]) -> NDArray[np.int64]:
        """The slots of a row that is recorded after `actions` of an event have read outputs."""
        read = {end for action in actions if isinstance(action, Read) for end in action.ends}
        slots = [
            self.memory.slot(end, "event" if end in read else "present")
            for end in self.plan.recorded
        ]
        return np.array(slots, dtype=np.int64)

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
                return transfer(self.memory, action, self._stored)
            case Slope():
                return self._slope(action)
            case Blend():
                return weigh(self.memory, action)
            case Keep():
                return [keep(self.memory, action)]
            case Record():
                return [[op.RECORD, 0, len(self.plan.recorded)]]
            case UnlessStop():
                return [[op.UNLESS_STOP, 0, op.TO_THE_END]]
            case ParticipantAction():
                return action.rows(self.participants[action.component])
        raise AssertionError(f"{action} has no rows")

    def _slope(self, action: Slope) -> Iterator[Row]:
        slots = self.memory.scratch(len(action.wires))
        yield from weigh(self.memory, action, slots, 1.0 / to_seconds(action.step_ns))
        inputs = [wire.target.variable for wire in action.wires]
        yield from self.participants[action.component].slopes(inputs, slots)

    def _iterate(self, action: Iterate) -> Iterator[tuple[Row, Action]]:
        memory, system = self.memory, self.plan.lowered.system
        first = memory.scratch(1 + 2 * len(action.wires))[0]
        iteration = Iteration(action, system, self.descriptions, first)
        self.iterations[action] = iteration
        inputs = [memory.slot(wire.target) for wire in action.wires]
        outputs = [memory.slot(wire.source, action.view) for wire in action.wires]
        scales = [(wire.factor, wire.offset) for wire in action.wires]
        yield memory.copy(inputs, iteration.assumed), action
        yield memory.copy(iteration.assumed, inputs), action
        body = [pair for inner in action.body for pair in self.operations(inner)]
        yield from body
        yield memory.copy(outputs, iteration.found, scales), action
        yield iteration.solve(memory.address(0)), action
        yield [op.REPEAT, iteration.first, -(len(body) + 3)], action

    def _stored(self, end: Endpoint) -> int:
        """How an FMU's input holds a real: rows show what it was given."""
        d = self.descriptions.get(end.component)
        if d is None:
            return op.EXACT
        kind = d.port(end.variable).type
        if kind in INTEGER_TYPES:
            return op.ROUND
        return {"Boolean": op.TRUTH, "Float32": op.SINGLE}.get(kind, op.EXACT)

    def _ports(self, action: Action) -> int:
        """Room that an action may need in the exchange buffer, in cells."""
        match action:
            case Read() | Write():
                return len(scalar_ports(action.ends, self.descriptions))
        return 0

    def _negated(self, action: Action) -> int:
        """Slots that an action may need beside those of the ports."""
        if not isinstance(action, Write):
            return 0
        d = self.descriptions[action.component]
        return sum(d.port(name).details.negated for name in action.variables)


def _fitting(value: Any, cell: Cell) -> Any:
    """A start value as its slot holds it: texts are empty where none is stated."""
    empty = {"text": "", "binary": b""}.get(cell)
    if empty is not None:
        return value if isinstance(value, type(empty)) else empty
    return value if cell == "real" or isinstance(value, int) else int(value)
