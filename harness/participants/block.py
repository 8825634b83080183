"""Discrete-time blocks, compiled: controllers, estimators, imperfections, delay lines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from harness.compiler import operations as op
from harness.compiler.step import compile_step
from harness.participants.memory import Memory, Row
from harness.participants.participant import Participant
from harness.system.graph import BlockComponent, Endpoint


class BlockParticipant(Participant):
    """A block; `state` is its live state, shape (n_x,)."""

    def __init__(self, component: BlockComponent) -> None:
        """Compiles the step where no machine code of it is there; raises `CompileError`."""
        super().__init__(component.name)
        self.component = component
        self._compiled = compile_step(component.block)
        self._parameters = component.block.parameters.copy()
        self.state = component.block.state.copy()

    def link(self, memory: Memory, participants: Mapping[str, Participant]) -> None:
        """Find where inputs and outputs lie."""
        super().link(memory, participants)
        self._u = self._first([s.name for s in self.component.inputs])
        self._y = self._first([s.name for s in self.component.outputs])

    def _first(self, names: list[str]) -> int:
        return self.memory.slot(Endpoint(self.name, names[0]), "present") if names else 0

    def compute(self) -> Iterator[Row]:
        """Step, and look whether what comes out is finite."""
        arrays = self._parameters.ctypes.data, self.state.ctypes.data
        u, y = self.memory.address(self._u), self.memory.address(self._y)
        yield [op.CALL_5, *self._compiled.call(*arrays, u, y)]
        yield [op.CHECK, self._y, self._y + len(self.component.outputs)]
