"""Compiled loops that a supervisor sees: their clock in shared memory, their operations by name."""

from __future__ import annotations

from collections.abc import Callable

from harness.master.host import Host
from harness.master.program.link import Program
from harness.participants.fmu import Told
from harness.process.marker import Marker
from harness.process.messages import Linked


class VisibleHost(Host):
    """The host of a run whose loop keeps its clock in `marker`; `send` is told what its
    operations are."""

    def __init__(self, marker: Marker, send: Callable[[Linked], None] | None = None) -> None:
        """The clock begins anew."""
        super().__init__()
        self.clock, self.told = marker.clock, Told(marker.time, marker.stop, marker.function)
        self.clock[:] = 0
        self._marker, self._send = marker, send

    def linked(self, program: Program) -> None:
        """Tell what its operations are."""
        if self._send is None:
            return
        system = program.plan.lowered.system
        names = {
            id(action): (getattr(action, "component", ""), action.call())
            for action in {id(action): action for action in program.owners}.values()
        }
        calls = tuple(names[id(action)] for action in program.owners)
        cycles = (system.stop_ns - system.start_ns) // program.plan.cycle_ns + 1
        self._send(Linked(calls, cycles, system.ticks_per_second))

    def loop(self, inside: bool) -> None:
        """Mark that the loop runs."""
        self._marker.looping(inside)
