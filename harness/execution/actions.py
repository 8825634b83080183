"""What a plan consists of: actions on named components, before addresses and slots exist."""

from __future__ import annotations

from dataclasses import dataclass

from harness.system.lowering import Wire


@dataclass(frozen=True)
class Sample:
    """Take the next value of a signal."""

    component: str


@dataclass(frozen=True)
class Transfer:
    """Copy along wires; with `ahead` from the values that FMUs have at the end of their step."""

    wires: tuple[Wire, ...]
    ahead: bool = False


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
    """Get outputs of an FMU; `ahead` keeps them apart from those at the present instant."""

    component: str
    outputs: tuple[str, ...]
    ahead: bool = False


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
