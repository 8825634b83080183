"""FMI 1.0: what is particular to it, in co-simulation ("slaves") and in model exchange ("models").

Functions carry the name of the model ("Ball_fmiGetReal"), booleans are one byte, callbacks are
passed by value, and there is no initialisation mode: all is set between instantiating and
initialising. Here `enter_initialization_mode` keeps the times, and `exit_initialization_mode`
initialises, so that callers need no case of their own.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import ClassVar

from harness.errors import FmuError
from harness.fmi.binding.fmi2 import PLAIN_TYPES, Fmi1Or2Instance, fields, memory
from harness.fmi.binding.instance import CO_SIMULATION, DiscreteStates
from harness.fmi.binding.logger import variadic_logger

_MIME_TYPE = b"application/x-fmu-sharedlibrary"
_TIMEOUT = 10_000.0  # ms


class _ModelCallbacks(ctypes.Structure):
    _fields_ = fields(ctypes.c_void_p, "logger", "allocate_memory", "free_memory")


class _SlaveCallbacks(ctypes.Structure):
    _fields_ = (*_ModelCallbacks._fields_, ("step_finished", ctypes.c_void_p))


class _EventInfo(ctypes.Structure):
    _fields_ = (
        *fields(
            ctypes.c_int8, "converged", "nominals_changed", "values_changed", "terminate", "timed"
        ),
        ("next_event_time", ctypes.c_double),
    )

    @property
    def needs_update(self) -> bool:
        return not self.converged


class Fmi1Instance(Fmi1Or2Instance):
    """An instance of an FMI 1.0 FMU."""

    prefix, boolean, event_info = "fmi", ctypes.c_int8, _EventInfo
    types: ClassVar = PLAIN_TYPES | {"Boolean": ("Boolean", ctypes.c_int8)}
    _times: tuple[float, float | None, float | None] = (0.0, None, None)
    _first: DiscreteStates | None = None

    def symbol(self, name: str) -> str:
        """The name of the model stands before that of the function."""
        return f"{self.capabilities.model_identifier}_fmi{name}"

    def _instantiate(self, folder: Path, logging: bool) -> int | None:
        s, i8 = ctypes.c_char_p, ctypes.c_int8
        callbacks = (variadic_logger(), *memory())
        named = s(self.name.encode()), s(self.description.token.encode())
        if self.interface_type != CO_SIMULATION:
            self.free_function = "FreeModelInstance"
            model = _ModelCallbacks(*callbacks)
            return self.create("InstantiateModel", *named, model, i8(logging))
        self.free_function = "FreeSlaveInstance"
        place = s(folder.as_uri().encode()), s(_MIME_TYPE), ctypes.c_double(_TIMEOUT)
        slave = _SlaveCallbacks(*callbacks, None)
        return self.create("InstantiateSlave", *named, *place, i8(0), i8(0), slave, i8(logging))

    def enter_initialization_mode(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """Keep the times for `exit_initialization_mode`; a model is told the time."""
        self._times = (start_time, stop_time, tolerance)
        if self.interface_type != CO_SIMULATION:
            self.call("SetTime", ctypes.c_double(start_time))

    def exit_initialization_mode(self) -> None:
        """fmiInitializeSlave, or fmiInitialize with its event information."""
        start, stop, tolerance = self._times
        if self.interface_type == CO_SIMULATION:
            defined = ctypes.c_int8(stop is not None)
            stop_time = ctypes.c_double(stop or 0.0)
            self.call("InitializeSlave", ctypes.c_double(start), defined, stop_time)
            return
        controlled = ctypes.c_int8(tolerance is not None)
        self._first = self.events("Initialize", controlled, ctypes.c_double(tolerance or 0.0))

    def terminate(self) -> None:
        """fmiTerminateSlave or fmiTerminate."""
        self.call("TerminateSlave" if self.interface_type == CO_SIMULATION else "Terminate")

    def reset(self) -> None:
        """fmiResetSlave; a model of FMI 1 cannot be reset."""
        if self.interface_type != CO_SIMULATION:
            raise FmuError(
                f"component {self.name}: a model-exchange FMU of FMI 1 cannot be reset; "
                "instantiate it again"
            )
        self.call("ResetSlave")

    # events and model exchange

    def enter_event_mode(self) -> None:
        """FMI 1 has no modes."""

    def update_discrete_states(self) -> DiscreteStates:
        """fmiEventUpdate; the first time after initialisation, what that said."""
        first, self._first = self._first, None
        return first or self.events("EventUpdate", ctypes.c_int8(0))
