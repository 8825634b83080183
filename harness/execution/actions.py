"""What a plan consists of: actions on named components, before addresses and slots exist."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from harness.system.lowering import Wire

View = Literal["present", "applied", "reached"]
"""Which values of an FMU's outputs: those read at the present instant, those after the inputs of
this instant have been applied (where outputs depend on them directly), or those at the end of the
step. Each is held until it is read again."""


@dataclass(frozen=True)
class Sample:
    """Take the next value of a signal."""

    component: str


@dataclass(frozen=True)
class Transfer:
    """Copy along wires, from the values of FMU outputs in `view`."""

    wires: tuple[Wire, ...]
    view: View = "present"


@dataclass(frozen=True)
class Compute:
    """Run a block or a plain Python controller."""

    component: str


@dataclass(frozen=True)
class Linearise:
    """Compute a sensitivity from the directional derivatives of its FMU."""

    component: str


@dataclass(frozen=True)
class Read:
    """Get outputs of an FMU; each `view` of them is kept apart."""

    component: str
    outputs: tuple[str, ...]
    view: View = "present"


@dataclass(frozen=True)
class Write:
    """Set inputs of an FMU."""

    component: str
    inputs: tuple[str, ...]


@dataclass(frozen=True)
class Step:
    """Let an FMU step from the present instant by `step_ns`."""

    component: str
    step_ns: int


@dataclass(frozen=True)
class Record:
    """Record a row."""


Action = Sample | Transfer | Compute | Linearise | Read | Write | Step | Record


@dataclass(frozen=True)
class Instant:
    """Actions at `offset_ns` after the beginning of each cycle, in order."""

    offset_ns: int
    actions: tuple[Action, ...]
