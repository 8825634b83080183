"""A participant under examination, stepped outside of the loop: what is examined is what runs.

Inputs are constant from one communication point to the next, as wires would give them. In model
exchange the solver begins anew at each point, so that a run can be left and taken up anywhere and
still gives the same bits. This module refuses to judge.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compiler.operations import CLOCK_SIZE
from harness.errors import EndRequestedError
from harness.fmi.binding.continuous import ContinuousPart
from harness.fmi.binding.groups import Group
from harness.fmi.binding.values import opposite
from harness.fmi.description.model_description import Variable
from harness.inspection.excitation import moving_inputs
from harness.inspection.subject import Array, Subject
from harness.participants import kinds as kinds
from harness.participants.driven import DrivenParticipant
from harness.participants.fmu import Around, FmuParticipant
from harness.participants.grid import exact
from harness.participants.memory import Layout, Memory
from harness.participants.model_exchange import ModelExchange
from harness.system.graph import FmuComponent
from harness.system.policy import Policy


class Trial:
    """A participant for a `subject`, with the settings of `simulate`; `ended`: the FMU has asked to
    end the simulation."""

    def __init__(
        self,
        subject: Subject,
        name: str = "subject",
        start_values: Mapping[str, Any] | None = None,
        triggers: Mapping[str, Any] | None = None,
    ) -> None:
        """Instantiated, and not initialised; `triggers` are inputs over time of clocks that the
        importer triggers."""
        s, step = subject.settings, exact(subject.step)
        policy = Policy(interface_type=subject.interface_type, tolerance=s.relative_tolerance,
                        largest_step=subject.step if subject.exchanges else None)  # fmt: skip
        component = FmuComponent(name, subject.fmu.path, step.numerator, start_values or {}, policy,
                                 inputs=triggers)  # fmt: skip
        around = Around(ticks_per_second=step.denominator)
        participant = FmuParticipant.of(component, subject.fmu, around)
        assert isinstance(participant, DrivenParticipant)
        self.subject, self.participant = subject, participant
        self.instance = participant.instance
        self.inputs = moving_inputs(subject.description, subject.start, subject.step)
        self.ended = False

    @property
    def part(self) -> ContinuousPart:
        """The continuous part, in model exchange."""
        assert isinstance(self.participant, ModelExchange)
        return self.participant.part

    @property
    def solves(self) -> bool:
        """Whether it is solved here."""
        return isinstance(self.participant, ModelExchange)

    def begin(self) -> None:
        """Initialise a fresh or reset instance, with the times and the tolerance of `simulate`."""
        self.ended = False
        self.inputs.forget()
        start = self.subject.start
        self.participant.enter_initialization(start, None)
        clock = np.zeros(CLOCK_SIZE, dtype=np.int64)
        self.participant.link(Memory(Layout(), clock), {})
        if isinstance(self.participant, ModelExchange):
            self.participant.driven_by_wires = True
        self.participant.leave_initialization(start)

    def advance(self, steps: int | None = None, first: float = 0, factor: float = 1.0) -> Array:
        """Give inputs and step; rows of what is watched after each step, shape (steps, n), fewer
        where the FMU ends the simulation.

        `steps` is the whole examination where None. The run is at step number `first`, and takes
        steps of `factor` times the usual length.
        """
        wanted = self.subject.steps if steps is None else steps
        rows: list[Array] = []
        while len(rows) < wanted and not self.ended:
            time, end = (self._time(first + factor * k) for k in (len(rows), len(rows) + 1))
            self.step(time, end)
            rows.append(self.watch())
        return np.array(rows).reshape(len(rows), len(self.subject.labels))

    def _time(self, number: float) -> float:
        return self.subject.start + number * self.subject.step

    def step(self, time: float, end: float) -> None:
        """Give the inputs as they are at `time`, and go on to `end` (s); raises `HarnessError`."""
        self.participant.give(self.inputs.changed(time))
        if isinstance(self.participant, ModelExchange):
            self.participant.begin_anew()
        try:
            self.participant.advance(time, end)
        except EndRequestedError:
            self.ended = True

    def watch(self) -> Array:
        """The watched variables, arrays element by element; in model exchange also the states and
        their derivatives."""
        row = np.empty(len(self.subject.labels))
        end = 0
        for places, group in self._groups:
            row[places] = group.read()
            end += len(places)
        for place, variable in self._negated:
            row[place] = opposite(variable, row[place])
        if self.solves:
            row[end:] = np.concatenate([self.part.states(), self.part.derivatives()])
        return row

    @cached_property
    def _groups(self) -> list[tuple[NDArray[np.int64], Group]]:
        """The columns of what is watched, and who reads them, for each kind of get function."""
        kinds: dict[str, list[tuple[int, Variable]]] = {}
        place = 0
        for v in self.subject.watched:
            kinds.setdefault(self.instance.types[v.type][0], []).append((place, v))
            place += v.size
        return [
            (np.concatenate([np.arange(at, at + v.size) for at, v in members]),
             self.instance.group(*(v for _, v in members)))
            for members in kinds.values()
        ]  # fmt: skip

    @cached_property
    def _negated(self) -> list[tuple[int, Variable]]:
        """Columns of scalars of FMI 1 that have the opposite sign of another one."""
        return [(i, v) for i, v in enumerate(self.subject.watched) if v.details.negated]

    def memory(self) -> dict[str, Any]:
        """What the importer must remember with a snapshot of the FMU, as plain values."""
        return self.participant.remembered()

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from where `memory` was taken; the FMU has returned there itself."""
        self.ended = False
        self.inputs.forget()
        self.participant.recall(memory)


@contextmanager
def running(subject: Subject, name: str = "subject") -> Iterator[Trial]:
    """A trial after initialisation; closed on leaving."""
    trial = Trial(subject, name)
    try:
        trial.begin()
        yield trial
    finally:
        trial.participant.close()
