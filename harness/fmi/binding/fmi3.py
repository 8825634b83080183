"""FMI 3.0: what is particular to it in instantiating, initialising and stepping an FMU."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from harness.fmi.binding.instance import (
    CO_SIMULATION,
    DISCARD,
    DiscreteStates,
    FmuInstance,
    StepOutcome,
)
from harness.fmi.binding.interface import SCHEDULED_EXECUTION
from harness.fmi.binding.library import instantiating
from harness.fmi.binding.logger import plain_logger
from harness.fmi.binding.values import NATIVE_TYPES

_INTERVAL_CHANGED = 2
_C_TYPES: dict[str, Any] = {
    name: np.ctypeslib.as_ctypes_type(dtype)
    for name, dtype in NATIVE_TYPES.items()
    if name not in ("Real", "Integer")
} | {"String": ctypes.c_char_p, "Binary": ctypes.py_object}

_CLOCK_UPDATE = ctypes.CFUNCTYPE(None, ctypes.c_void_p)
_PREEMPTION = ctypes.CFUNCTYPE(None)


@_PREEMPTION  # type: ignore[untyped-decorator]
def _unlocked() -> None:
    """lockPreemption and unlockPreemption: partitions run one after the other."""


class Fmi3Instance(FmuInstance):
    """An instance of an FMI 3.0 FMU; intermediate update is not used."""

    prefix, boolean = "fmi3", ctypes.c_bool
    types: ClassVar = {name: (name, ctype) for name, ctype in _C_TYPES.items()} | {
        "Enumeration": ("Int64", ctypes.c_int64)
    }

    def _instantiate(self, folder: Path, logging: bool) -> int | None:
        b, s, p = ctypes.c_bool, ctypes.c_char_p, ctypes.c_void_p
        resources = folder / "resources"
        path = f"{resources}{os.sep}".encode() if resources.is_dir() else None
        modes: tuple[Any, ...] = ()
        others: tuple[Any, ...] = ()
        if self.interface_type == CO_SIMULATION:
            modes = b(self.event_mode), b(self.early_return), p(None), ctypes.c_size_t(0)
            others = (p(None),)
        elif self.interface_type == SCHEDULED_EXECUTION:
            self._callbacks = (_CLOCK_UPDATE(self._count_update), _unlocked, _unlocked)
            others = self._callbacks
        return self.create(
            instantiating(self.interface_type),
            s(self.name.encode()), s(self.description.token.encode()), s(path), b(False),
            b(logging), *modes, p(self._environment), p(plain_logger()), *others,
        )  # fmt: skip

    clock_updates = 0
    """How often clockUpdate was called, in scheduled execution."""

    def _count_update(self, environment: int | None) -> None:
        self.clock_updates += 1

    def activate(self, clock: str, time: float) -> None:
        """fmi3ActivateModelPartition of a clock at `time` (s)."""
        reference = ctypes.c_uint32(self.description.variable(clock).value_reference)
        what = f" of {clock!r} at t = {time:.9g} s"
        self.call("ActivateModelPartition", reference, ctypes.c_double(time), what=what)

    def enter_initialization_mode(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """fmi3EnterInitializationMode."""
        self.call("EnterInitializationMode", *self.experiment(start_time, stop_time, tolerance))

    def advance(self, time: float, step: float) -> StepOutcome:
        """fmi3DoStep without a state to return to; it may return early."""
        event, terminate, early = (ctypes.pointer(ctypes.c_bool()) for _ in range(3))
        last = ctypes.pointer(ctypes.c_double(time + step))
        numbers = (ctypes.c_double(time), ctypes.c_double(step), ctypes.c_bool(True))
        status = self.status("DoStep", *numbers, event, terminate, early, last)
        ends = terminate.contents.value
        if status == DISCARD:
            return StepOutcome(time, False, ends, True)
        self.check(status, "DoStep", f" at t = {time:.9g} s")
        reached = last.contents.value if early.contents.value else time + step
        return StepOutcome(reached, event.contents.value, ends)

    def configure(self, values: Mapping[str, int]) -> None:
        """Set structural parameters, by which the sizes of arrays change."""
        self.call("EnterConfigurationMode")
        self.set(values)
        self.call("ExitConfigurationMode")
        self.description = self.description.configured(values)

    def update_discrete_states(self) -> DiscreteStates:
        """fmi3UpdateDiscreteStates."""
        flags = [ctypes.pointer(ctypes.c_bool()) for _ in range(5)]
        time = ctypes.pointer(ctypes.c_double())
        self.call("UpdateDiscreteStates", *flags, time)
        needs, end, nominals, values, defined = (flag.contents.value for flag in flags)
        return DiscreteStates(
            needs, end, nominals, values, time.contents.value if defined else None
        )

    def interval(self, clock: str) -> float | None:
        """fmi3GetIntervalDecimal of a clock (s): None where it is not known or has not changed
        since it was last asked for."""
        reference = ctypes.pointer(
            ctypes.c_uint32(self.description.variable(clock).value_reference)
        )
        interval, qualifier = ctypes.pointer(ctypes.c_double()), ctypes.pointer(ctypes.c_int())
        self.call("GetIntervalDecimal", reference, ctypes.c_size_t(1), interval, qualifier)
        return interval.contents.value if qualifier.contents.value == _INTERVAL_CHANGED else None
