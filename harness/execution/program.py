"""The linker: from a plan and live instances to the arrays that the loop executes.

All memory to which the program holds addresses belongs to the `Program` and lives as long as it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.execution import operations as op
from harness.execution.actions import (
    Action,
    Compute,
    Linearise,
    Read,
    Record,
    Sample,
    Step,
    Transfer,
    View,
    Write,
)
from harness.execution.compile import compile_step
from harness.execution.layout import FLOAT64, Layout, access, make_layout
from harness.execution.plan import Plan
from harness.execution.python_block import PythonCallback
from harness.execution.sensitivity import Linearisation
from harness.fmi.instance import FmuInstance
from harness.system.graph import (
    BlockComponent,
    Endpoint,
    PythonComponent,
    SensitivityComponent,
    SignalComponent,
)


@dataclass
class Program:
    """A linked plan: what `loop.run_cycles` takes, and whose operation each row is.

    `initial` is the one instant that propagates values during initialisation, `instants` are
    those of a cycle; instants that share their actions share their rows. `owners[i]` is the action
    behind row i of `code`; `states` are the live states of the blocks by name.
    """

    plan: Plan
    layout: Layout
    v: NDArray[np.float64]
    clock: NDArray[np.int64]
    exchange: NDArray[np.uint8]
    recorded: NDArray[np.int64]
    code: NDArray[np.int64] = field(init=False)
    instants: NDArray[np.int64] = field(init=False)
    initial: NDArray[np.int64] = field(init=False)
    copies: NDArray[np.int64] = field(init=False)
    scales: NDArray[np.float64] = field(init=False)
    owners: list[Action] = field(default_factory=list)
    signals: list[SignalComponent] = field(default_factory=list)
    states: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    callbacks: dict[str, PythonCallback] = field(default_factory=dict)
    keep: list[Any] = field(default_factory=list)


def link(
    plan: Plan, instances: Mapping[str, FmuInstance], clock: NDArray[np.int64] | None = None
) -> Program:
    """Bind `plan` to live instances; raises `FmuError` or `CompileError`.

    The loop keeps its `clock` in the array given, or in one of its own.
    """
    return _Linker(plan, instances, clock).link()


class _Linker:
    def __init__(
        self,
        plan: Plan,
        instances: Mapping[str, FmuInstance],
        clock: NDArray[np.int64] | None,
    ) -> None:
        self.plan = plan
        self.instances = instances
        descriptions = {name: i.description for name, i in instances.items()}
        self.layout = make_layout(plan, descriptions)
        self.components = {c.name: c for c in plan.lowered.components}
        distinct = {action for actions in plan.patterns for action in actions}
        room = sum(map(_ports, distinct | set(plan.initial)))
        self.program = Program(
            plan,
            self.layout,
            v=np.zeros(self.layout.size),
            clock=np.zeros(5, dtype=np.int64) if clock is None else clock,
            exchange=np.zeros(8 * (1 + room), dtype=np.uint8),
            recorded=np.array([self.layout.slots[end] for end in plan.recorded], dtype=np.int64),
        )
        self.base: int = self.program.v.ctypes.data
        self.exchange_base: int = self.program.exchange.ctypes.data
        self.exchange_used = 0
        self.copies: list[tuple[int, int]] = []
        self.scales: list[tuple[float, float]] = []
        self.shared: dict[Any, list[list[int]]] = {}

    def link(self) -> Program:
        program = self.program
        for component in self.plan.lowered.sampled:
            for signal in [*component.inputs, *component.outputs]:
                program.v[self.layout.slots[Endpoint(component.name, signal.name)]] = signal.start
        rows: list[list[int]] = []
        spans: dict[int, tuple[int, int]] = {}
        for actions in (self.plan.initial, *self.plan.patterns):
            first = len(rows)
            for action in actions:
                operations = self.operations(action)
                rows += operations
                program.owners += [action] * len(operations)
            spans[id(actions)] = (first, len(rows))
        program.code = np.zeros((len(rows), op.WIDTH), dtype=np.int64)
        for i, row in enumerate(rows):
            program.code[i, : len(row)] = row
        program.initial = np.array([(0, *spans[id(self.plan.initial)])], dtype=np.int64)
        program.instants = np.array(
            [(instant.offset_ns, *spans[id(instant.actions)]) for instant in self.plan.instants],
            dtype=np.int64,
        ).reshape(-1, 3)
        program.copies = np.array(self.copies, dtype=np.int64).reshape(-1, 2)
        program.scales = np.array(self.scales, dtype=np.float64).reshape(-1, 2)
        return program

    def operations(self, action: Action) -> list[list[int]]:
        """The rows of an action; equal actions share one set of memory."""
        if action not in self.shared:
            self.shared[action] = list(self._operations(action))
        return self.shared[action]

    def _operations(self, action: Action) -> Iterable[list[int]]:
        match action:
            case Transfer():
                return [self._transfer(action)]
            case Sample():
                return [self._sample(action.component)]
            case Compute():
                return self._compute(action.component)
            case Linearise():
                return self._linearise(action.component)
            case Read():
                return self._read(action)
            case Write():
                return self._write(action)
            case Step():
                return [self._step(action)]
            case Record():
                return [[op.RECORD]]

    def _transfer(self, action: Transfer) -> list[int]:
        first = len(self.copies)
        for wire in action.wires:
            source = self.layout.slot(wire.source, action.view)
            self.copies.append((source, self.layout.slots[wire.target]))
            self.scales.append((wire.factor, wire.offset))
        return [op.COPY, first, len(self.copies)]

    def _sample(self, name: str) -> list[int]:
        component = self.components[name]
        assert isinstance(component, SignalComponent)
        self.program.signals.append(component)  # once: equal actions share their rows
        index = len(self.program.signals) - 1
        return [op.SAMPLE, index, self.layout.slots[Endpoint(name, "value")]]

    def _compute(self, name: str) -> Iterable[list[int]]:
        component = self.components[name]
        assert isinstance(component, (BlockComponent, PythonComponent))
        u = self._pointer(name, [s.name for s in component.inputs])
        y = self._pointer(name, [s.name for s in component.outputs])
        first_u, first_y = (u - self.base) // 8, (y - self.base) // 8
        last_y = first_y + len(component.outputs)
        if isinstance(component, PythonComponent):
            inputs = self.program.v[first_u : first_u + len(component.inputs)]
            outputs = self.program.v[first_y:last_y]
            callback = PythonCallback(component, self.program.clock, inputs, outputs)
            self.program.callbacks[name] = callback
            yield [op.CALL_4, callback.address, 0, 0, 0, 0]
        else:
            compiled = compile_step(component.block)
            p, x = component.block.parameters.copy(), component.block.state.copy()
            self.program.states[name] = x
            self.program.keep += [compiled, p]
            yield compiled.operation(p.ctypes.data, x.ctypes.data, u, y)
        yield [op.CHECK, first_y, last_y]

    def _pointer(self, name: str, variables: Sequence[str]) -> int:
        if not variables:
            return self.base
        return self.base + 8 * self.layout.slots[Endpoint(name, variables[0])]

    def _linearise(self, name: str) -> Iterable[list[int]]:
        component = self.components[name]
        assert isinstance(component, SensitivityComponent)
        linearisation = Linearisation(component, self.instances[component.component])
        self.program.keep.append(linearisation)
        yield from linearisation.operations(self._pointer(name, ["value"]))

    def _read(self, action: Read) -> Iterable[list[int]]:
        for suffix, kind, ends in self._groups(action.component, action.outputs, action.view):
            first = self.layout.slot(ends[0], action.view)
            yield from self._access("Get", action.component, suffix, kind, ends, first)
            if kind in (FLOAT64, op.FLOAT32):
                yield [op.CHECK, first, first + len(ends)]

    def _write(self, action: Write) -> Iterable[list[int]]:
        for suffix, kind, ends in self._groups(action.component, action.inputs):
            first = self.layout.slots[ends[0]]
            yield from self._access("Set", action.component, suffix, kind, ends, first)

    def _groups(
        self, name: str, variables: Sequence[str], view: View = "present"
    ) -> Iterable[tuple[str, int, list[Endpoint]]]:
        """Ports of one C type that lie side by side, so that one call reads or writes them."""
        d = self.instances[name].description

        def slot(end: Endpoint) -> int:
            return self.layout.slot(end, view)

        def neighbours(place: tuple[int, Endpoint]) -> tuple[tuple[str, int], int]:
            i, end = place
            return access(d.variable(end.variable), d.fmi_major), slot(end) - i

        ends = sorted((Endpoint(name, variable) for variable in variables), key=slot)

        for ((suffix, kind), _), group in groupby(enumerate(ends), key=neighbours):
            yield suffix, kind, [end for _, end in group]

    def _access(
        self, verb: str, name: str, suffix: str, kind: int, ends: list[Endpoint], first: int
    ) -> Iterable[list[int]]:
        instance = self.instances[name]
        n = len(ends)
        references = np.array(
            [instance.description.variable(end.variable).value_reference for end in ends],
            dtype=np.uint32,
        )
        self.program.keep.append(references)
        start = 0
        values = self.base + 8 * first
        if kind != FLOAT64:
            start, values = self._reserve(n * op.ITEM_SIZE[kind])
        call = [instance.address(verb + suffix), instance.handle or 0, references.ctypes.data, n]
        row = [op.CALL_4, *call, values]
        if instance.prefix == "fmi3":
            row = [op.CALL_5, *call, values, n]
        code = [] if kind == FLOAT64 else [[kind, first, first + n, start]]
        if verb == "Set":
            yield from ([op.ENCODE, *operands] for operands in code)
        yield row
        if verb == "Get":
            yield from ([op.DECODE, *operands] for operands in code)

    def _reserve(self, n_bytes: int) -> tuple[int, int]:
        """Room in the exchange buffer: its offset (a multiple of 8) and its address."""
        start = self.exchange_used
        self.exchange_used += -(-n_bytes // 8) * 8
        assert self.exchange_used <= self.program.exchange.size
        return start, self.exchange_base + start

    def _step(self, action: Step) -> list[int]:
        instance = self.instances[action.component]
        head = [instance.address("DoStep"), instance.handle or 0, action.step_ns]
        if instance.prefix == "fmi2":
            return [op.STEP_FMI2, *head]
        start, flags = self._reserve(8)
        last = np.zeros(1)
        self.program.keep.append(last)
        return [op.STEP_FMI3, *head, flags, last.ctypes.data, start]


def _ports(action: Action) -> int:
    """Room that an action may need in the exchange buffer, in units of 8 bytes."""
    match action:
        case Read():
            return len(action.outputs)
        case Write():
            return len(action.inputs)
        case Step():
            return 1
    return 0
