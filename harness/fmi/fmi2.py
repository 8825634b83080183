"""FMI 2.0: what is particular to it in instantiating, initialising and stepping an FMU."""

from __future__ import annotations

import ctypes
from functools import cache
from pathlib import Path
from typing import Any

from harness.errors import FmuError
from harness.fmi.instance import FmuInstance
from harness.fmi.logger import variadic_logger
from harness.fmi.model_description import INTEGER_TYPES, REAL_TYPES, Variable

_CO_SIMULATION = 1
_TERMINATED = 3  # of fmi2StatusKind


class _Callbacks(ctypes.Structure):
    _fields_ = (
        ("logger", ctypes.c_void_p),
        ("allocate_memory", ctypes.c_void_p),
        ("free_memory", ctypes.c_void_p),
        ("step_finished", ctypes.c_void_p),
        ("environment", ctypes.c_void_p),
    )


@cache
def _memory() -> tuple[int | None, int | None]:
    import sys

    library = ctypes.CDLL("msvcrt" if sys.platform == "win32" else None)
    functions = (library.calloc, library.free)
    addresses = [ctypes.cast(function, ctypes.c_void_p).value for function in functions]
    return addresses[0], addresses[1]


class Fmi2Instance(FmuInstance):
    """An instance of an FMI 2.0 FMU."""

    prefix = "fmi2"

    def _instantiate(self, folder: Path, logging: bool) -> int | None:
        allocate, release = _memory()
        self._callbacks = _Callbacks(
            variadic_logger(), allocate, release, None, self._environment
        )  # lives as long as the instance
        function = ctypes.CFUNCTYPE(
            ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p,
            ctypes.c_void_p, ctypes.c_int, ctypes.c_int,
        )(self.address("Instantiate"))  # fmt: skip
        handle: int | None = function(
            self.name.encode(),
            _CO_SIMULATION,
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
        self.call(
            "SetupExperiment",
            ctypes.c_int(tolerance is not None),
            ctypes.c_double(tolerance or 0.0),
            ctypes.c_double(start_time),
            ctypes.c_int(stop_time is not None),
            ctypes.c_double(stop_time or 0.0),
        )
        self.call("EnterInitializationMode")

    def do_step(self, time: float, step: float) -> None:
        """fmi2DoStep without a state to return to."""
        arguments = (ctypes.c_double(time), ctypes.c_double(step), ctypes.c_int(1))
        self.call("DoStep", *arguments, what=f" at t = {time:.9g} s")

    def asks_for_the_end(self) -> bool:
        """fmi2GetBooleanStatus(fmi2Terminated), after a step that was discarded."""
        if self._library.find("fmi2GetBooleanStatus") is None:
            return False
        value = ctypes.pointer(ctypes.c_int())
        try:
            self.call("GetBooleanStatus", ctypes.c_int(_TERMINATED), value)
        except FmuError:  # it does not know, so the step was discarded for another reason
            return False
        return value.contents.value != 0

    def accessor(self, variable: Variable) -> tuple[str, Any]:
        """Real, Integer (also enumerations), Boolean or String."""
        if variable.type in REAL_TYPES:
            return "Real", ctypes.c_double
        if variable.type in INTEGER_TYPES:
            return "Integer", ctypes.c_int
        if variable.type == "Boolean":
            return "Boolean", ctypes.c_int
        if variable.type == "String":
            return "String", ctypes.c_char_p
        raise FmuError(f"variable {variable.name!r} has type {variable.type}, unknown in FMI 2")
