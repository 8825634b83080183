"""What a plan consists of: actions on named components, before addresses and slots exist."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from harness.participants.memory import View
from harness.system.lowering import Wire


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
    """Let an FMU step from the present instant by `step_ns`; a step that may be undone is not
    `final`."""

    component: str
    step_ns: int
    final: bool = True


@dataclass(frozen=True)
class Record:
    """Record a row."""


@dataclass(frozen=True)
class Blend:
    """Change the value at the targets of wires by what the sources were at other times:

    target <- own * target + sum over terms (view, weight) of weight * (value in that view)
    """

    wires: tuple[Wire, ...]
    own: float
    terms: tuple[tuple[View, float], ...]


@dataclass(frozen=True)
class Slope:
    """Tell an FMU by how much its inputs change during the coming step of `step_ns`:

    own * target + sum over terms (view, weight) of weight * (value in that view)
    """

    component: str
    wires: tuple[Wire, ...]
    own: float
    terms: tuple[tuple[View, float], ...]
    step_ns: int


@dataclass(frozen=True)
class Keep:
    """Let the present values of an FMU's outputs be the previous ones from now on."""

    component: str
    outputs: tuple[str, ...]


@dataclass(frozen=True)
class Save:
    """Take a snapshot of an FMU's state; the one before is given up."""

    component: str


@dataclass(frozen=True)
class Restore:
    """Return an FMU to its snapshot."""

    component: str


@dataclass(frozen=True)
class UnlessStop:
    """At the stop time the instant ends here."""


@dataclass(frozen=True)
class Iterate:
    """Repeat `body` until the targets of `wires` have the values that it begins with.

    Before each repetition the targets get the values assumed for them, at first those that they
    have; after it, what the wires bring from `view` is compared with the assumption.
    """

    wires: tuple[Wire, ...]
    view: View
    body: tuple[Action, ...]


Action = (
    Sample | Transfer | Compute | Linearise | Read | Write | Step | Record
    | Blend | Slope | Keep | Save | Restore | UnlessStop | Iterate
)  # fmt: skip


def flat(actions: Iterable[Action]) -> Iterator[Action]:
    """The actions, with those inside of repetitions after the repetition itself."""
    for action in actions:
        yield action
        if isinstance(action, Iterate):
            yield from flat(action.body)


@dataclass(frozen=True)
class Instant:
    """Actions at `offset_ns` after the beginning of each cycle, in order."""

    offset_ns: int
    actions: tuple[Action, ...]
