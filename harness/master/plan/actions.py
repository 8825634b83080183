"""What a plan consists of: actions on named components, before addresses and slots exist.

As text an action is a line of the schedule; `call` names it in the sentence on a fault.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import ClassVar

from harness.clock import show
from harness.participants.memory import Row, View
from harness.participants.participant import Participant
from harness.system.graph import Endpoint
from harness.system.lowering import Wire


class Action:
    """One thing that is done at an instant."""

    def call(self) -> str:
        """What is asked of a component, as a phrase."""
        return type(self).__name__


@dataclass(frozen=True)
class ParticipantAction(Action):
    """What one participant is asked for."""

    component: str

    def rows(self, participant: Participant) -> Iterable[Row]:
        """The rows of the program that do it."""
        return participant.compute()


class Sample(ParticipantAction):
    """Take the next value of a signal."""

    def __str__(self) -> str:
        return f"sample signal {self.component}"


class Compute(ParticipantAction):
    """Run a block or a plain Python controller."""

    def __str__(self) -> str:
        return f"compute {self.component}"

    def call(self) -> str:
        """Of a block."""
        return "its step function"


class Linearise(ParticipantAction):
    """Compute a sensitivity from the directional derivatives of its FMU."""

    def __str__(self) -> str:
        return f"linearise for {self.component}"

    def call(self) -> str:
        """Of its FMU."""
        return "directional derivative"


@dataclass(frozen=True)
class PortAction(ParticipantAction):
    """What is done with some of the variables of an FMU."""

    variables: tuple[str, ...]

    @property
    def names(self) -> str:
        """The variables, as text."""
        return ", ".join(self.variables)

    @property
    def ends(self) -> list[Endpoint]:
        """The variables with their component."""
        return [Endpoint(self.component, name) for name in self.variables]


@dataclass(frozen=True)
class Read(PortAction):
    """Get outputs of an FMU; each `view` of them has a place of its own."""

    view: View = "present"

    def __str__(self) -> str:
        when = {"applied": " after its inputs", "reached": " at the end of its step"}
        return f"read {self.component}: {self.names}{when.get(self.view, '')}"

    def call(self) -> str:
        """With all names."""
        return f"getting {self.names}"

    def rows(self, participant: Participant) -> Iterable[Row]:
        """Get functions."""
        return participant.read(self.variables, self.view)


class Write(PortAction):
    """Set inputs of an FMU."""

    def __str__(self) -> str:
        return f"write {self.component}: {self.names}"

    def call(self) -> str:
        """With all names."""
        return f"setting {self.names}"

    def rows(self, participant: Participant) -> Iterable[Row]:
        """Set functions."""
        return participant.write(self.variables)


@dataclass(frozen=True)
class Step(ParticipantAction):
    """Let an FMU step from the present instant by `step_ns`; a step that may be undone is not
    `final`."""

    step_ns: int
    final: bool = True

    def __str__(self) -> str:
        return f"step {self.component} by {show(self.step_ns)}"

    def call(self) -> str:
        """With its length."""
        return f"doStep by {show(self.step_ns)}"

    def rows(self, participant: Participant) -> Iterable[Row]:
        """A step of any kind of interface."""
        return participant.step(self.step_ns, self.final)


class Save(ParticipantAction):
    """Take a snapshot of an FMU's state; the one before is given up."""

    def __str__(self) -> str:
        return f"save the state of {self.component}"

    def call(self) -> str:
        """Of FMI."""
        return "getting the FMU state"

    def rows(self, participant: Participant) -> Iterable[Row]:
        """The FMU's state, and what the importer knows besides."""
        return participant.save()


class Restore(ParticipantAction):
    """Return an FMU to its snapshot."""

    def __str__(self) -> str:
        return f"restore the state of {self.component}"

    def call(self) -> str:
        """Of FMI."""
        return "setting the FMU state"

    def rows(self, participant: Participant) -> Iterable[Row]:
        """The FMU's state, and what the importer knows besides."""
        return participant.restore()


@dataclass(frozen=True)
class WireAction(Action):
    """What is done along wires."""

    wires: tuple[Wire, ...]

    @property
    def targets(self) -> str:
        """The ends of the wires, as text."""
        return ", ".join(str(wire.target) for wire in self.wires)


@dataclass(frozen=True)
class Transfer(WireAction):
    """Copy along wires, from the values of FMU outputs in `view`."""

    view: View = "present"

    def __str__(self) -> str:
        how = "copy " if self.view == "present" else f"copy what was {self.view}: "
        return how + ", ".join(f"{w.source} -> {w.target}" for w in self.wires)


@dataclass(frozen=True)
class Blend(WireAction):
    """Change the value at the targets of wires by what the sources were at other times:

    target <- own * target + sum over terms (view, weight) of weight * (value in that view)
    """

    own: float
    terms: tuple[tuple[View, float], ...]

    def __str__(self) -> str:
        weights = ", ".join(f"{weight:+g} × {view}" for view, weight in self.terms)
        return f"blend: {self.own:g} × {self.targets}, {weights} of what drives them"


@dataclass(frozen=True)
class Slope(Blend):
    """Tell an FMU, the `component`, by how much its inputs change during the coming step of
    `step_ns`:

    own * target + sum over terms (view, weight) of weight * (value in that view)
    """

    component: str
    step_ns: int

    def __str__(self) -> str:
        return f"set the slopes of {self.targets}"

    def call(self) -> str:
        """Of FMI."""
        return "setting input derivatives"


@dataclass(frozen=True)
class Iterate(WireAction):
    """Repeat `body` until the targets of `wires` have the values that it begins with.

    Before each repetition the targets get the values assumed for them, at first those that they
    have; after it, what the wires bring from `view` is compared with the assumption.
    """

    view: View
    body: tuple[Action, ...]

    def __str__(self) -> str:
        return f"repeat until {self.targets} agree:"


class Keep(PortAction):
    """Let the present values of an FMU's outputs be the previous ones from now on."""

    view: ClassVar[View] = "previous"

    def __str__(self) -> str:
        return f"keep as previous: {self.component}.{self.names}"


@dataclass(frozen=True)
class Record(Action):
    """Record a row."""

    def __str__(self) -> str:
        return "record a row"


@dataclass(frozen=True)
class UnlessStop(Action):
    """At the stop time the instant ends here."""

    def __str__(self) -> str:
        return "end here at the stop time"


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
