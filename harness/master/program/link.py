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

from harness.clock import to_seconds
from harness.compiler.step import compile_step
from harness.fmi.binding.instance import FmuInstance
from harness.master.plan.actions import (
    Action,
    Blend,
    Compute,
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
    View,
    Write,
    flat,
)
from harness.master.plan.planner import Plan
from harness.master.program import operations as op
from harness.master.program.copying import CopyTable
from harness.master.program.iteration import Iteration, snapshot
from harness.master.program.layout import (
    FLOAT64,
    Layout,
    access,
    earlier_names,
    make_layout,
    whole,
)
from harness.master.program.python_block import PythonCallback
from harness.master.program.sensitivity import Linearisation
from harness.master.program.start_values import start_values
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
    behind row i of `code`; `states` are the live states of the blocks by name, `snapshots` the
    places of pointers to FMU states that the run has to free.
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
    iterations: dict[Iterate, Iteration] = field(default_factory=dict)
    snapshots: dict[str, NDArray[np.int64]] = field(default_factory=dict)
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
        self.descriptions = {name: i.description for name, i in instances.items()}
        self.layout = make_layout(plan, self.descriptions)
        self.components = {c.name: c for c in plan.lowered.components}
        distinct = set(flat([*plan.initial, *(a for actions in plan.patterns for a in actions)]))
        room = sum(map(self._ports, distinct))
        solving = sum(1 + 2 * len(a.wires) for a in distinct if isinstance(a, (Iterate, Slope)))
        self.program = Program(
            plan,
            self.layout,
            v=np.zeros(self.layout.size + solving),
            clock=np.zeros(5, dtype=np.int64) if clock is None else clock,
            exchange=np.zeros(8 * (1 + room), dtype=np.uint8),
            recorded=np.array([self.layout.slots[end] for end in plan.recorded], dtype=np.int64),
        )
        self.base: int = self.program.v.ctypes.data
        self.exchange_base: int = self.program.exchange.ctypes.data
        self.exchange_used = 0
        self.slots_used = self.layout.size
        self.copies = CopyTable(self.layout)
        self.shared: dict[Any, list[tuple[list[int], Action]]] = {}

    def link(self) -> Program:
        program = self.program
        for end, value in start_values(self.plan, self.descriptions).items():
            program.v[self.layout.slots[end]] = value
        rows: list[list[int]] = []
        spans: dict[int, tuple[int, int]] = {}
        for actions in (self.plan.initial, *self.plan.patterns):
            first = len(rows)
            for action in actions:
                for row, owner in self.operations(action):
                    rows.append(row)
                    program.owners.append(owner)
            spans[id(actions)] = (first, len(rows))
        program.code = np.zeros((len(rows), op.WIDTH), dtype=np.int64)
        for i, row in enumerate(rows):
            program.code[i, : len(row)] = row
        program.initial = np.array([(0, *spans[id(self.plan.initial)])], dtype=np.int64)
        program.instants = np.array(
            [(instant.offset_ns, *spans[id(instant.actions)]) for instant in self.plan.instants],
            dtype=np.int64,
        ).reshape(-1, 3)
        program.copies, program.scales = self.copies.arrays()
        return program

    def operations(self, action: Action) -> list[tuple[list[int], Action]]:
        """The rows of an action and whose they are; equal actions share one set of memory."""
        if action not in self.shared:
            if isinstance(action, Iterate):
                self.shared[action] = list(self._iterate(action))
            else:
                self.shared[action] = [(row, action) for row in self._operations(action)]
        return self.shared[action]

    def _operations(self, action: Action) -> Iterable[list[int]]:
        match action:
            case Transfer():
                return [self.copies.transfer(action)]
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
            case Blend():
                return self.copies.weigh(action)
            case Slope():
                return self._slope(action)
            case Keep():
                return [self.copies.keep(action)]
            case Save() | Restore():
                place = self.program.snapshots.setdefault(action.component, np.zeros(1, np.int64))
                instance = self.instances[action.component]
                return [snapshot(instance, place, save=isinstance(action, Save))]
            case UnlessStop():
                return [[op.UNLESS_STOP]]
            case Iterate():
                raise AssertionError("an iteration has rows of several actions")

    def _slope(self, action: Slope) -> Iterable[list[int]]:
        instance, n = self.instances[action.component], len(action.wires)
        slopes = range(self.slots_used, self.slots_used + n)
        self.slots_used += n
        per_second = 1.0 / to_seconds(action.step_ns)
        yield from self.copies.weigh(action, slopes, per_second)
        variables = [instance.description.variable(wire.target.variable) for wire in action.wires]
        references = np.array([v.value_reference for v in variables], dtype=np.uint32)
        orders = np.ones(n, dtype=np.int32)
        self.program.keep += [references, orders]
        head = [instance.address("SetRealInputDerivatives"), instance.handle or 0]
        values = self.base + 8 * slopes[0]
        yield [op.CALL_5, *head, references.ctypes.data, n, orders.ctypes.data, values]

    def _iterate(self, action: Iterate) -> Iterable[tuple[list[int], Action]]:
        iteration = Iteration(action, self.plan.lowered.system, self.instances, self.slots_used)
        self.program.iterations[action] = iteration
        self.slots_used = iteration.last
        inputs = [self.layout.slots[wire.target] for wire in action.wires]
        outputs = [self.layout.slot(wire.source, action.view) for wire in action.wires]
        scales = [(wire.factor, wire.offset) for wire in action.wires]
        yield self.copies.row(inputs, iteration.assumed), action
        yield self.copies.row(iteration.assumed, inputs), action
        body = [pair for inner in action.body for pair in self.operations(inner)]
        yield from body
        yield self.copies.row(outputs, iteration.found, scales), action
        yield iteration.solve(self.base), action
        yield [op.REPEAT, iteration.first, len(body) + 3], action

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
            yield [op.CALL_5, *compiled.call(p.ctypes.data, x.ctypes.data, u, y)]
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
        """Ports of one C type that lie side by side and share no value reference, so that one call
        reads or writes them."""
        d = self.instances[name].description

        def slot(end: Endpoint) -> int:
            return self.layout.slot(end, view)

        def neighbours(place: tuple[int, Endpoint]) -> tuple[tuple[str, int], int, int]:
            i, end = place
            return access(d.port(end.variable), d.fmi_major), slot(end) - i, earlier[end]

        touched = whole((Endpoint(name, variable) for variable in variables), self.descriptions)
        ends = sorted(touched, key=slot)
        earlier = earlier_names(ends, self.descriptions)
        for ((suffix, kind), *_), group in groupby(enumerate(ends), key=neighbours):
            yield suffix, kind, [end for _, end in group]

    def _access(
        self, verb: str, name: str, suffix: str, kind: int, ends: list[Endpoint], first: int
    ) -> Iterable[list[int]]:
        instance = self.instances[name]
        n = len(ends)
        ports = (instance.description.port(end.variable) for end in ends)
        distinct = dict.fromkeys(port.value_reference for port in ports)  # an array has one
        references = np.array(list(distinct), dtype=np.uint32)
        self.program.keep.append(references)
        start = 0
        values = self.base + 8 * first
        if kind != FLOAT64:
            start, values = self._reserve(n * op.ITEM_SIZE[kind])
        call = [instance.address(verb + suffix), instance.handle or 0, references.ctypes.data]
        call.append(len(references))
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
            return [op.STEP_FMI2, *head, int(action.final)]
        start, flags = self._reserve(8)
        last = np.full(1, op.UNTOUCHED)
        self.program.keep.append(last)
        return [op.STEP_FMI3, *head, flags, last.ctypes.data, start, int(action.final)]

    def _ports(self, action: Action) -> int:
        """Room that an action may need in the exchange buffer, in units of 8 bytes."""
        match action:
            case Read(name, variables) | Write(name, variables):
                return len(whole((Endpoint(name, v) for v in variables), self.descriptions))
            case Step():
                return 1
        return 0
