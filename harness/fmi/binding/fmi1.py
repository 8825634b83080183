"""FMI 1.0: what is particular to it, in co-simulation ("slaves") and in model exchange ("models").

Functions carry the name of the model ("Ball_fmiGetReal"), booleans are one byte, callbacks are
passed by value, and there is no initialisation mode: all is set between instantiating and
initialising. Here `enter_initialization_mode` keeps the times, and `exit_initialization_mode`
initialises, so that callers need no case of their own.
"""

from __future__ import annotations

import ctypes
from pathlib import Path

from harness.errors import FmuError
from harness.fmi.binding.fmi2 import Fmi1Or2Instance, memory
from harness.fmi.binding.instance import CO_SIMULATION, DiscreteStates
from harness.fmi.binding.logger import forget_name, register_name, variadic_logger

_MIME_TYPE = b"application/x-fmu-sharedlibrary"
_TIMEOUT = 10_000.0  # ms


class _ModelCallbacks(ctypes.Structure):
    _fields_ = (
        ("logger", ctypes.c_void_p),
        ("allocate_memory", ctypes.c_void_p),
        ("free_memory", ctypes.c_void_p),
    )


class _SlaveCallbacks(ctypes.Structure):
    _fields_ = (*_ModelCallbacks._fields_, ("step_finished", ctypes.c_void_p))


class _EventInfo(ctypes.Structure):
    _fields_ = (
        ("iteration_converged", ctypes.c_int8),
        ("state_value_references_changed", ctypes.c_int8),
        ("state_values_changed", ctypes.c_int8),
        ("terminate_simulation", ctypes.c_int8),
        ("upcoming_time_event", ctypes.c_int8),
        ("next_event_time", ctypes.c_double),
    )

    def states(self) -> DiscreteStates:
        return DiscreteStates(
            needs_update=not self.iteration_converged,
            terminate=bool(self.terminate_simulation),
            nominals_changed=bool(self.state_value_references_changed),
            values_changed=bool(self.state_values_changed),
            next_event_time=self.next_event_time if self.upcoming_time_event else None,
        )


class Fmi1Instance(Fmi1Or2Instance):
    """An instance of an FMI 1.0 FMU."""

    prefix, boolean = "fmi", ctypes.c_int8

    def symbol(self, name: str) -> str:
        """The name of the model stands before that of the function."""
        return f"{self.capabilities.model_identifier}_fmi{name}"

    def _instantiate(self, folder: Path, logging: bool) -> int | None:
        self._times: tuple[float, float | None, float | None] = (0.0, None, None)
        self._first: DiscreteStates | None = None
        register_name(self.name, self.log)
        callbacks = (variadic_logger(), *memory())
        s, p, i8 = ctypes.c_char_p, ctypes.c_void_p, ctypes.c_int8
        named = self.name.encode(), self.description.token.encode()
        handle: int | None
        if self.interface_type == CO_SIMULATION:
            self.free_function = "FreeSlaveInstance"
            function = ctypes.CFUNCTYPE(
                p, s, s, s, s, ctypes.c_double, i8, i8, _SlaveCallbacks, i8
            )(self.address("InstantiateSlave"))  # fmt: skip
            place = folder.as_uri().encode(), _MIME_TYPE
            slave = _SlaveCallbacks(*callbacks, None)
            handle = function(*named, *place, _TIMEOUT, 0, 0, slave, int(logging))
        else:
            self.free_function = "FreeModelInstance"
            build = ctypes.CFUNCTYPE(p, s, s, _ModelCallbacks, i8)(self.address("InstantiateModel"))
            handle = build(*named, _ModelCallbacks(*callbacks), int(logging))
        return handle

    def free(self) -> None:
        """Free the instance; harmless when it is gone already."""
        super().free()
        forget_name(self.name, self.log)

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
        info = ctypes.pointer(_EventInfo())
        controlled = ctypes.c_int8(tolerance is not None)
        self.call("Initialize", controlled, ctypes.c_double(tolerance or 0.0), info)
        self._first = info.contents.states()

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

    def leave_event_mode(self) -> None:
        """FMI 1 has no modes."""

    def update_discrete_states(self) -> DiscreteStates:
        """fmiEventUpdate; the first time after initialisation, what that said."""
        first, self._first = self._first, None
        if first is not None:
            return first
        info = ctypes.pointer(_EventInfo())
        self.call("EventUpdate", ctypes.c_int8(0), info)
        return info.contents.states()

    def completed_integrator_step(self) -> tuple[bool, bool]:
        """Whether an event follows, and False: FMI 1 cannot ask for the end here."""
        event = ctypes.pointer(ctypes.c_int8())
        self.call("CompletedIntegratorStep", event)
        return bool(event.contents.value), False
