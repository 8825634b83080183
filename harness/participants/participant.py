"""What a plan moves: one interface for FMUs of every version and kind, blocks, plain Python and
signals.

The calls of a life, in this order; each may raise a `HarnessError`:

    participant = FmuParticipant.of(component, fmu, …), Block(component), …
    enter_initialization(start, stop)   start values are set, times and tolerance are told
    link(memory, participants)          from now on rows may be asked for
    rows: read, write                   laid into the program that propagates initial values
    leave_initialization(time)          also the event that ends it, where there are events
    rows: compute, read, write, step, save, restore, slopes   executed by the loop, in the order
                                        of the plan
    fault                               what a call of this participant came to, where it is more
                                        than a status
    terminate()                         unless something failed
    close()                             always

A participant lays rows of opcodes and operands (`operations`) into the program, among them
addresses of the C functions that do the work: those of an FMU, those of a compiled block, or a
callback. What a step comes to is the status of those functions, 0 to 5 as in FMI; `ASKED` + an
outcome of `operations` says more. One file defines one kind.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from harness.participants.memory import Memory, Row, View
from harness.system.graph import Component, Endpoint


class Participant:
    """The default of every call: nothing is done, and no row is needed."""

    fault: BaseException | None = None
    """What ended a call of this participant, where it came from Python."""
    notes: Sequence[str] = ()
    """What had to be derived, left out or done otherwise in this run."""

    component: Any

    def __init__(self, component: Component) -> None:
        """Its `name` is that of the component."""
        self.component, self.name = component, component.name

    def enter_initialization(self, start: float, stop: float) -> None:
        """Begin initialisation (times in s)."""

    def link(self, memory: Memory, participants: Mapping[str, Participant]) -> None:
        """Take the memory of the program; `participants` are all of the system."""
        self.memory = memory

    def slot(self, name: str) -> int:
        """Where the present value of an input or output lies."""
        return self.memory.slot(Endpoint(self.name, name))

    def leave_initialization(self, time: float) -> None:
        """End initialisation at `time` (s); steps may follow."""

    def compute(self) -> Iterator[Row]:
        """What is done at a sample instant of this participant."""
        return iter(())

    def read(self, outputs: Sequence[str], view: View = "present") -> Iterator[Row]:
        """Bring outputs into the slots of that view."""
        return iter(())

    def write(self, inputs: Sequence[str]) -> Iterator[Row]:
        """Take inputs from their slots."""
        return iter(())

    def step(self, ticks: int, final: bool) -> Iterator[Row]:
        """Go on by that much time; one that may be undone is not `final`."""
        return iter(())

    def save(self) -> Iterator[Row]:
        """Take a snapshot; the one before is given up."""
        return iter(())

    def restore(self) -> Iterator[Row]:
        """Return to the snapshot."""
        return iter(())

    def slopes(self, inputs: Sequence[str], slots: Sequence[int]) -> Iterator[Row]:
        """Take the derivatives of inputs (per s) from slots that lie side by side."""
        return iter(())

    def explained(self, status: int) -> BaseException | None:
        """What that status of a call of this participant means, where it is no plain status."""
        return self.fault

    def terminate(self) -> None:
        """End the simulation."""

    def close(self) -> None:
        """Give everything back; harmless when done twice."""
