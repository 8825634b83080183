"""What falls due at which instant of a cycle.

The planner orders what happens at an instant by what is due there and by nothing else, so
instants at which the same things are due share one list of actions.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
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

    def __init__(self) -> None:
        """An empty cycle; its first instant is there whether something is due or not."""
        self._events: defaultdict[int, list[Event]] = defaultdict(list, {0: []})

    def enter(self, event: Event, offsets: Iterable[int]) -> None:
        """Something that is due at these offsets (ns) in the cycle."""
        for offset in offsets:
            self._events[offset].append(event)

    def instants(self) -> list[tuple[int, tuple[Event, ...]]]:
        """Offset and events of each instant, in order of time."""
        return [(offset, tuple(events)) for offset, events in sorted(self._events.items())]
