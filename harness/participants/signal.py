"""Signals: samples prepared ahead, one taken at each instant."""

from __future__ import annotations

from collections.abc import Iterator

from harness.compiler import operations as op
from harness.participants.memory import Row
from harness.participants.participant import Participant
from harness.system.graph import Endpoint, SignalComponent


class SignalParticipant(Participant):
    """A signal source, the `number`-th of its program."""

    def __init__(self, component: SignalComponent, number: int) -> None:
        """The samples lie in the order of the numbers."""
        super().__init__(component.name)
        self.component, self.number = component, number

    def compute(self) -> Iterator[Row]:
        """Take the next sample."""
        slot = self.memory.slot(Endpoint(self.name, "value"), "present")
        yield [op.SAMPLE, self.number, slot]
