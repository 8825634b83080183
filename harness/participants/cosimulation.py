"""Co-simulation of FMI 1, 2 and 3: a step is one call of the FMU's doStep by address."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from harness.compiler import operations as op
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.interface import CO_SIMULATION
from harness.participants.fmu import FmuParticipant
from harness.participants.memory import Row
from harness.system.graph import Endpoint


class CoSimulation(FmuParticipant):
    """An FMU that brings its own solver."""

    kind = CO_SIMULATION

    def instantiate(self) -> FmuInstance:
        """Without event mode and without early return."""
        return self.made()

    def step(self, ticks: int, final: bool) -> Iterator[Row]:
        """One doStep."""
        head = [self.instance.address("DoStep"), self.instance.handle or 0, ticks]
        if self.instance.prefix != "fmi3":
            # FMI 1 is told that this is a new step, FMI 2 that the state before is not needed
            last = 1 if self.instance.prefix == "fmi" else int(final)
            yield [op.STEP_FMI2, *head, last]
            return
        start, flags = self.memory.reserve(8)
        last_time = self.memory.held(np.full(1, op.UNTOUCHED))
        yield [op.STEP_FMI3, *head, flags, last_time, start, int(final)]

    def slopes(self, inputs: Sequence[str], slots: Sequence[int]) -> Iterator[Row]:
        """fmi2SetRealInputDerivatives of first order."""
        ends = [Endpoint(self.name, name) for name in inputs]
        orders = np.ones(len(ends), dtype=np.int32)
        head = [self.instance.address("SetRealInputDerivatives"), self.instance.handle or 0]
        references = self.memory.held(self.access.references(ends))
        values = self.memory.address(slots[0])
        yield [op.CALL_5, *head, references, len(ends), self.memory.held(orders), values]
