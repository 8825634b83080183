"""Discrete-time blocks, compiled: controllers, estimators, imperfections, delay lines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from harness.compiler import operations as op
from harness.compiler.step import compile_step
from harness.participants.memory import Memory, Row
from harness.participants.participant import Participant
from harness.system.graph import BlockComponent


class BlockParticipant(Participant):
    """A block; `state` is its live state, shape (n_x,)."""

    component: BlockComponent

    def __init__(self, component: BlockComponent) -> None:
        """Compiles the step where no machine code of it is there; raises `CompileError`."""
        super().__init__(component)
        self._compiled = compile_step(component.block)
        self._parameters = component.block.parameters.copy()
        self.state = component.block.state.copy()

    def link(self, memory: Memory, participants: Mapping[str, Participant]) -> None:
        """Find where inputs and outputs lie."""
        super().link(memory, participants)
        ends = self.component.inputs, self.component.outputs
        self._u, self._y = (self.slot(signals[0].name) if signals else 0 for signals in ends)

    def compute(self) -> Iterator[Row]:
        """Step, and look whether what comes out is finite."""
        arrays = self._parameters.ctypes.data, self.state.ctypes.data
        u, y = self.memory.address(self._u), self.memory.address(self._y)
        address, *operands = self._compiled.call(*arrays, u, y)
        n_u, n_y = len(self.component.inputs), len(self.component.outputs)
        if self._compiled.leaves_inputs:
            yield [op.BLOCK, self._compiled.inner, n_y, *operands, n_u]
        else:
            yield [op.CALL_5, address, *operands]
            yield [op.CHECK, self._y, n_y]
