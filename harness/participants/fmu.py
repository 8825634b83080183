"""What participants of all kinds of FMU have in common: an instance, from its instantiation to its
end, and rows that get and set its variables."""

from __future__ import annotations

import ctypes
from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.clock import NANOSECONDS
from harness.compiler import operations as op
from harness.errors import FmuError
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.interface import InterfaceType
from harness.fmi.binding.logger import LogMessage
from harness.fmi.fmu import Fmu
from harness.fmi.start_values import apply_start_values, judge_start_values
from harness.participants.access import Access
from harness.participants.memory import Memory, Row, View
from harness.participants.participant import Participant
from harness.system.graph import FmuComponent
from harness.system.policy import capabilities_of, interface, tolerance_of

Observer = Callable[[float], None]
"""Records a row at a time (s) inside a step."""
_KINDS: dict[InterfaceType, type[FmuParticipant]] = {}


@dataclass(frozen=True, eq=False)
class Told:
    """Where long steps tell the time that they have `reached` (s), look whether to end, and tell
    which function is under way; shape (1,) each."""

    reached: NDArray[np.float64] = field(default_factory=lambda: np.zeros(1))
    stop_asked: NDArray[np.int64] = field(default_factory=lambda: np.zeros(1, np.int64))
    function: NDArray[np.int64] = field(default_factory=lambda: np.zeros(1, np.int64))


@dataclass(frozen=True)
class Around:
    """What a run gives to its FMUs: whether and where they log, the number of ticks in a second,
    and what goes on inside of long steps."""

    logging: bool = False
    echo: Callable[[str, LogMessage], None] | None = None
    ticks_per_second: int = NANOSECONDS
    told: Told = field(default_factory=Told)


class FmuParticipant(Participant):
    """An FMU; `instance` is its live instance. A subclass serves one kind of interface."""

    kind: ClassVar[InterfaceType]
    component: FmuComponent

    def __init_subclass__(cls) -> None:
        if "kind" in vars(cls):
            _KINDS[cls.kind] = cls

    @staticmethod
    def of(component: FmuComponent, fmu: Fmu, around: Around) -> FmuParticipant:
        """The participant for a component, instantiated; raises `HarnessError`."""
        kind = interface(component.policy.interface_type, fmu.description)
        return _KINDS[kind](component, fmu, around)

    def __init__(self, component: FmuComponent, fmu: Fmu, around: Around) -> None:
        """Instantiate; raises `FmuError`."""
        super().__init__(component)
        self.fmu, self.around = fmu, around
        self.notes: list[str] = []
        self.description = fmu.description
        self.capabilities = capabilities_of(component.policy, fmu.description)
        self.tolerance = tolerance_of(component.policy, fmu.description)
        self._place = np.zeros(1, dtype=np.int64)
        if self.capabilities.needs_execution_tool:
            self.notes.append(f"component {self.name}: its FMU says that it needs its tool to run")
        self.instance = self.instantiate()
        self.notes += self.instance.notes
        self.instance.notes = self.notes

    def instantiate(self) -> FmuInstance:
        """A new instance of the kind that this participant serves."""
        return self.made()

    def made(self, *, event_mode: bool = False, early_return: bool = False) -> FmuInstance:
        """A new instance with the run's log."""
        echo, name = self.around.echo, self.name
        return self.fmu.instantiate(
            name, interface_type=self.kind, event_mode=event_mode, early_return=early_return,
            logging=self.around.logging, echo=None if echo is None else lambda m: echo(name, m),
        )  # fmt: skip

    # life

    def set_start_values(self) -> None:
        """Judge and set what the user gave."""
        given, validate = self.component.start_values, self.component.policy.validate
        judged = judge_start_values(self.description, given, component=self.name, validate=validate)
        self.notes += judged.notes
        apply_start_values(self.instance, judged)

    def link(self, memory: Memory, participants: Mapping[str, Participant]) -> None:
        """Prepare access to variables."""
        super().link(memory, participants)
        allow = self.component.policy.allow_not_finite
        self.access = Access(self.name, self.instance, memory, allow)

    def leave_initialization(self, time: float) -> None:
        """Exit initialisation mode."""
        self.instance.exit_initialization_mode()

    def terminate(self) -> None:
        """Terminate; what the FMU returns changes nothing that was computed."""
        try:
            self.instance.terminate()
        except FmuError as fault:
            self.notes.append(str(fault))

    def close(self) -> None:
        """Give back the snapshot and the instance."""
        if self._place[0] and self.instance.alive:
            self.instance.free_state(ctypes.c_void_p(int(self._place[0])))
        self._place[0] = 0
        self.instance.free()

    @abstractmethod
    def observe(self, observer: Observer, room: int) -> None:
        """From now on `observer` records rows at events inside steps, of which there is `room` for
        so many."""

    def explained(self, status: int) -> BaseException | None:
        """What Python has found, also in an access to texts."""
        return self.fault or self.access.fault

    # rows

    def read(self, outputs: Sequence[str], view: View = "present") -> Iterator[Row]:
        """Get variables."""
        return self.access.read(outputs, view)

    def write(self, inputs: Sequence[str]) -> Iterator[Row]:
        """Set variables."""
        return self.access.write(inputs)

    def save(self) -> Iterator[Row]:
        """Get the FMU state."""
        yield [op.CALL_2, *self._state("Get"), self._place.ctypes.data]

    def restore(self) -> Iterator[Row]:
        """Set the FMU state."""
        yield [op.CALL_2_AT, *self._state("Set"), self._place.ctypes.data]

    def _state(self, verb: str) -> list[int]:
        name = "FMUState" if self.instance.prefix == "fmi3" else "FMUstate"
        return [self.instance.address(verb + name), self.instance.handle or 0]
