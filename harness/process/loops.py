"""The loop as the supervisor sees it: its clock in shared memory, its operations by name."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from harness.master import host as hosts
from harness.master.faults import call_name
from harness.master.host import Host
from harness.master.program.link import Program
from harness.process.marker import Marker
from harness.process.messages import Linked


def linked_program(program: Program) -> Linked:
    """What each operation of the program is."""
    places: dict[int, int] = {}
    calls: list[tuple[str, str]] = []
    index = np.zeros(len(program.owners), dtype=np.int32)
    for i, action in enumerate(program.owners):
        if id(action) not in places:
            places[id(action)] = len(calls)
            calls.append((getattr(action, "component", ""), call_name(action)))
        index[i] = places[id(action)]
    system = program.plan.lowered.system
    cycles = (system.stop_ns - system.start_ns) // program.plan.cycle_ns + 1
    return Linked(tuple(calls), index.tobytes(), cycles)


def show_loops(marker: Marker, send: Callable[[Linked], None]) -> None:
    """From now on the loops of this process keep their clock in `marker`, and `send` is told what
    their operations are."""

    class Shown(Host):
        """A run that is seen and otherwise on its own."""

        def __init__(self) -> None:
            super().__init__()
            self.clock = marker.clock

        def linked(self, program: Program) -> None:
            """Tell what its operations are."""
            send(linked_program(program))

        def loop(self, inside: bool) -> None:
            """Mark that the loop runs."""
            marker.looping(inside)

    hosts.usual = Shown
