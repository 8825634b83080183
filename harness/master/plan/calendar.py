"""What falls due at which instant of a cycle.

The planner orders what happens at an instant by what is due there and by nothing else, so
instants at which the same things are due share one list of actions.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from enum import Enum, auto
from typing import NamedTuple


class Role(Enum):
    """Why something is due."""

    ARRIVE = auto()
    """the value of a delay line leaves it"""
    SAMPLE = auto()
    """a block, signal or sensitivity is computed"""
    TAKE = auto()
    """a delay line takes in what its source has computed"""
    RECORD = auto()
    """a row is recorded"""
    STEP = auto()
    """an FMU steps"""


class Event(NamedTuple):
    """A component that is due in a role; `step_ns` is how far an FMU steps."""

    role: Role
    name: str = ""
    step_ns: int = 0


class Calendar:
    """Collects events; within one role they keep the order in which they were entered."""

    def __init__(self, cycle_ns: int) -> None:
        """An empty cycle; its first instant is there whether something is due or not."""
        self.cycle_ns = cycle_ns
        self._events: defaultdict[int, list[Event]] = defaultdict(list)
        self._events[0] = []

    def enter(self, event: Event, offsets: Iterable[int]) -> None:
        """Something that is due at these offsets (ns) in the cycle."""
        for offset in offsets:
            self._events[offset].append(event)

    def enter_steps(self, name: str, grid: Sequence[int]) -> None:
        """An FMU that steps from each of its communication points to the next."""
        for offset, following in zip(grid, [*grid[1:], self.cycle_ns], strict=True):
            self._events[offset].append(Event(Role.STEP, name, following - offset))

    def instants(self) -> list[tuple[int, tuple[Event, ...]]]:
        """Offset and events of each instant, in order of time."""
        return [(offset, tuple(events)) for offset, events in sorted(self._events.items())]
