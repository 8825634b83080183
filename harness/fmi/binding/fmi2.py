"""FMI 2.0: what is particular to it in instantiating, initialising and stepping an FMU, and what
it has in common with FMI 1.0."""

from __future__ import annotations

import ctypes
from contextlib import suppress
from functools import cache
from pathlib import Path
from time import sleep
from typing import Any

from harness.errors import FmuError
from harness.fmi.binding.instance import (
    CO_SIMULATION,
    DISCARD,
    DiscreteStates,
    FmuInstance,
    StepOutcome,
)
from harness.fmi.binding.logger import variadic_logger
from harness.fmi.description.model_description import INTEGER_TYPES, REAL_TYPES, Variable

_PENDING = 5
_DO_STEP_STATUS, _LAST_SUCCESSFUL_TIME, _TERMINATED = 0, 2, 3  # of fmi2StatusKind
_MODEL_EXCHANGE_KIND, _CO_SIMULATION_KIND = 0, 1  # of fmi2Type


class _Callbacks(ctypes.Structure):
    _fields_ = (
        ("logger", ctypes.c_void_p),
        ("allocate_memory", ctypes.c_void_p),
        ("free_memory", ctypes.c_void_p),
        ("step_finished", ctypes.c_void_p),
        ("environment", ctypes.c_void_p),
    )


class _EventInfo(ctypes.Structure):
    _fields_ = (
        ("new_discrete_states_needed", ctypes.c_int),
        ("terminate_simulation", ctypes.c_int),
        ("nominals_changed", ctypes.c_int),
        ("values_changed", ctypes.c_int),
        ("next_event_time_defined", ctypes.c_int),
        ("next_event_time", ctypes.c_double),
    )


@cache
def memory() -> tuple[int | None, int | None]:
    """Addresses of calloc and free, which FMUs of FMI 1 and 2 receive."""
    import sys

    library = ctypes.CDLL("msvcrt" if sys.platform == "win32" else None)
    functions = (library.calloc, library.free)
    addresses = [ctypes.cast(function, ctypes.c_void_p).value for function in functions]
    return addresses[0], addresses[1]


class Fmi1Or2Instance(FmuInstance):
    """Steps and values of FMI 1.0 and 2.0."""

    def advance(self, time: float, step: float) -> StepOutcome:
        """DoStep without a state to return to; after Discard, how far it came."""
        arguments = (ctypes.c_double(time), ctypes.c_double(step), self.boolean(1))
        status = self._final(self.status("DoStep", *arguments))
        if status == DISCARD:
            terminate = self.asks_for_the_end()
            return StepOutcome(self._last_successful_time(time), False, terminate, True)
        self.check(status, "DoStep", f" at t = {time:.9g} s")
        return StepOutcome(time + step)

    def _final(self, status: int) -> int:
        """The status in which a step ends that an FMU does in the background (Pending)."""
        kind, found = ctypes.c_int(_DO_STEP_STATUS), ctypes.pointer(ctypes.c_int(status))
        while status == _PENDING:
            sleep(1e-4)
            self.call("GetStatus", kind, found)
            status = found.contents.value
        return status

    def _last_successful_time(self, time: float) -> float:
        last, kind = ctypes.pointer(ctypes.c_double(time)), ctypes.c_int(_LAST_SUCCESSFUL_TIME)
        known = self.offers("GetRealStatus") and self.status("GetRealStatus", kind, last) in (0, 1)
        return last.contents.value if known else time

    def accessor(self, variable: Variable) -> tuple[str, Any]:
        """Real, Integer (also enumerations), Boolean or String."""
        if variable.type in REAL_TYPES:
            return "Real", ctypes.c_double
        if variable.type in INTEGER_TYPES:
            return "Integer", ctypes.c_int
        others = {"Boolean": self.boolean, "String": ctypes.c_char_p}
        if variable.type not in others:
            raise FmuError(
                f"variable {variable.name!r} has type {variable.type}, unknown in FMI "
                f"{self.description.fmi_major}"
            )
        return variable.type, others[variable.type]


class Fmi2Instance(Fmi1Or2Instance):
    """An instance of an FMI 2.0 FMU."""

    prefix, boolean = "fmi2", ctypes.c_int

    def _instantiate(self, folder: Path, logging: bool) -> int | None:
        allocate, release = memory()
        self._callbacks = _Callbacks(
            variadic_logger(), allocate, release, None, self._environment
        )  # lives as long as the instance
        function = ctypes.CFUNCTYPE(
            ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p,
            ctypes.c_void_p, ctypes.c_int, ctypes.c_int,
        )(self.address("Instantiate"))  # fmt: skip
        handle: int | None = function(
            self.name.encode(),
            _CO_SIMULATION_KIND if self.interface_type == CO_SIMULATION else _MODEL_EXCHANGE_KIND,
            self.description.token.encode(),
            (folder / "resources").as_uri().encode(),
            ctypes.addressof(self._callbacks),
            0,
            int(logging),
        )
        return handle

    def enter_initialization_mode(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """fmi2SetupExperiment and fmi2EnterInitializationMode."""
        self.call("SetupExperiment", *self.experiment(start_time, stop_time, tolerance))
        self.call("EnterInitializationMode")

    def asks_for_the_end(self) -> bool:
        """fmi2GetBooleanStatus(fmi2Terminated), after a step that was discarded."""
        if not self.offers("GetBooleanStatus"):
            return False
        value = ctypes.pointer(ctypes.c_int())
        with suppress(FmuError):  # it does not know, so the step was discarded for another reason
            self.call("GetBooleanStatus", ctypes.c_int(_TERMINATED), value)
            return value.contents.value != 0
        return False

    def update_discrete_states(self) -> DiscreteStates:
        """fmi2NewDiscreteStates."""
        info = ctypes.pointer(_EventInfo())
        self.call("NewDiscreteStates", info)
        i = info.contents
        return DiscreteStates(
            needs_update=bool(i.new_discrete_states_needed),
            terminate=bool(i.terminate_simulation),
            nominals_changed=bool(i.nominals_changed),
            values_changed=bool(i.values_changed),
            next_event_time=i.next_event_time if i.next_event_time_defined else None,
        )
