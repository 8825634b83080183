"""FMI 3.0: what is particular to it in instantiating, initialising and stepping an FMU."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

from harness.errors import FmuError
from harness.fmi.instance import FmuInstance
from harness.fmi.logger import fmi3_logger
from harness.fmi.model_description import Variable

_TYPES = {
    "Float32": ctypes.c_float, "Float64": ctypes.c_double, "Int8": ctypes.c_int8,
    "UInt8": ctypes.c_uint8, "Int16": ctypes.c_int16, "UInt16": ctypes.c_uint16,
    "Int32": ctypes.c_int32, "UInt32": ctypes.c_uint32, "Int64": ctypes.c_int64,
    "UInt64": ctypes.c_uint64, "Boolean": ctypes.c_bool, "String": ctypes.c_char_p,
}  # fmt: skip


class Fmi3Instance(FmuInstance):
    """An instance of an FMI 3.0 FMU; event mode and early return are not used."""

    prefix = "fmi3"

    def _instantiate(self, folder: Path, logging: bool) -> int | None:
        b, s, p = ctypes.c_bool, ctypes.c_char_p, ctypes.c_void_p
        function = ctypes.CFUNCTYPE(
            p, s, s, s, b, b, b, b, p, ctypes.c_size_t, p, p, p
        )(self.address("InstantiateCoSimulation"))  # fmt: skip
        resources = folder / "resources"
        handle: int | None = function(
            self.name.encode(),
            self.description.token.encode(),
            f"{resources}/".encode() if resources.is_dir() else None,
            False,
            logging,
            False,
            False,
            None,
            0,
            self._environment,
            ctypes.cast(fmi3_logger, ctypes.c_void_p),
            None,
        )
        return handle

    def enter_initialization_mode(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """fmi3EnterInitializationMode."""
        self.call(
            "EnterInitializationMode",
            ctypes.c_bool(tolerance is not None),
            ctypes.c_double(tolerance or 0.0),
            ctypes.c_double(start_time),
            ctypes.c_bool(stop_time is not None),
            ctypes.c_double(stop_time or 0.0),
        )

    def do_step(self, time: float, step: float) -> None:
        """fmi3DoStep without a state to return to."""
        flags = [ctypes.pointer(ctypes.c_bool()) for _ in range(3)]
        last = ctypes.pointer(ctypes.c_double())
        arguments = (
            ctypes.c_double(time),
            ctypes.c_double(step),
            ctypes.c_bool(True),
            *flags,
            last,
        )
        self.call("DoStep", *arguments, what=f" at t = {time:.9g} s")

    def accessor(self, variable: Variable) -> tuple[str, Any]:
        """One pair of functions a type; enumerations are Int64."""
        name = "Int64" if variable.type == "Enumeration" else variable.type
        if name not in _TYPES:
            raise FmuError(f"variable {variable.name!r} of type {name} cannot be read or set here")
        return name, _TYPES[name]
