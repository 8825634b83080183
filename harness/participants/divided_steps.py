"""Communication steps that an FMU discards, tried again in smaller ones.

A step may be repeated from a snapshot of the state before it, where the FMU can give and take
snapshots; it is halved until the FMU takes it, and grows again afterwards. Where there are no
snapshots but the FMU says that it came some way (last successful time), the run goes on from
there. Otherwise, and after `MOST_HALVINGS`, the step stays discarded: nothing is guessed.
"""

from __future__ import annotations

import ctypes
from contextlib import suppress
from dataclasses import replace

from harness.errors import FmuError
from harness.fmi.binding.instance import FmuInstance, StepOutcome
from harness.participants.grid import is_close

MOST_HALVINGS = 20


class Stepper:
    """Takes the steps of one instance."""

    def __init__(
        self, instance: FmuInstance, notes: list[str], usual: float, divides: bool
    ) -> None:
        """`usual` is the length of a step (s); whether discarded ones are divided; `notes` are
        told of the first that had to be."""
        self._instance, self._notes, self._usual = instance, notes, usual
        can = instance.capabilities
        self._divisible = divides and can.can_handle_variable_step
        self._snapshots = self._divisible and can.can_get_and_set_fmu_state
        self._state = ctypes.c_void_p()
        self._size = float("inf")  # that the FMU took last, after one that it did not

    def advance(self, time: float, target: float) -> tuple[StepOutcome, float]:
        """Step from `time` towards `target` (s): how the step ended, and the time at which it was
        to end, which is before `target` where the FMU takes no longer step."""
        self._save()
        length = target - time
        size = min(length, 2.0 * self._size)
        for _ in range(MOST_HALVINGS + 1):
            end = target if size >= length else time + size
            part = end - time
            part = self._usual if is_close(part, self._usual, self._usual) else part
            outcome = self._instance.advance(time, part)
            if not outcome.discarded or outcome.terminate:
                self._size = size if size < length else float("inf")
                return outcome, end
            if not self._restore():
                break
            self._note(time)
            size /= 2.0
        if self._divisible and not self._snapshots and time < outcome.time < end:
            self._note(time)
            return replace(outcome, discarded=False), outcome.time
        return outcome, end

    @property
    def is_free(self) -> bool:
        """Whether the next step is tried in its whole length."""
        return self._size == float("inf")

    @property
    def place(self) -> int:
        """The address of the pointer to the snapshot; 0 where there are none."""
        return ctypes.addressof(self._state) if self._snapshots else 0

    def close(self) -> None:
        """Give the snapshot back."""
        if self._state and self._instance.alive:
            with suppress(FmuError):  # the simulation is over
                self._instance.free_state(self._state)
            self._state = ctypes.c_void_p()

    def _save(self) -> None:
        """Take a snapshot; an FMU that cannot do what it promised does without."""
        if not self._snapshots or self._instance.tried is not None:
            return
        try:
            self._instance.get_state(self._state)
        except FmuError as fault:
            if not self._instance.alive:
                raise
            self._snapshots = False
            self._notes.append(f"steps that are discarded cannot be repeated, since: {fault}")

    def _restore(self) -> bool:
        if self._snapshots:
            self._instance.set_state(self._state)
        return self._snapshots

    def _note(self, time: float) -> None:
        told = "the FMU discarded steps, from t = "
        if not any(note.startswith(told) for note in self._notes):
            self._notes.append(f"{told}{time:.9g} s on; smaller ones were taken instead")
