"""Signals: samples prepared ahead, one taken at each instant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from harness.compiler import operations as op
from harness.participants.memory import Memory, Row
from harness.participants.participant import Participant


class SignalParticipant(Participant):
    """A signal source; `number` is its place among those of its program."""

    def link(self, memory: Memory, participants: Mapping[str, Participant]) -> None:
        """The samples lie in the order of the numbers."""
        super().link(memory, participants)
        signals = [p for p in participants.values() if isinstance(p, SignalParticipant)]
        self.number = signals.index(self)

    def compute(self) -> Iterator[Row]:
        """Take the next sample."""
        yield [op.SAMPLE, self.number, self.slot("value")]
