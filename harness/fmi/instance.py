"""One instance of an FMU in co-simulation: its life cycle and its values, FMI 2 and FMI 3 alike.

Everything outside the loop goes through here, one ctypes call at a time; the loop itself takes
the addresses (`address`, `handle`) and calls them directly. Statuses are treated as the standard
says: Warning goes on, Discard and Error raise, after Fatal nothing is called any more, not even
free.

This module refuses FMI 1, model exchange and scheduled execution.
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from harness.errors import FmuError
from harness.fmi.library import library_path, load
from harness.fmi.logger import STATUS_NAMES, LogMessage, MessageLog, forget, register
from harness.fmi.mark import calling, returned
from harness.fmi.model_description import INTEGER_TYPES, REAL_TYPES, ModelDescription, Variable

DISCARD = 2
FATAL = 4
Value = float | int | bool | str


class FmuInstance(ABC):
    """An instantiated FMU; use as a context manager, or call `free`.

    `handle` is the component pointer, `log` the messages received so far.
    """

    def __init__(
        self,
        description: ModelDescription,
        folder: Path,
        name: str,
        *,
        logging: bool = False,
        echo: Callable[[LogMessage], None] | None = None,
    ) -> None:
        """Load and instantiate; raises `FmuError` with what the FMU logged."""
        if description.co_simulation is None:
            raise FmuError(f"FMU {description.name} offers no co-simulation")
        self.description = description
        self.name = name
        self.log = MessageLog(echo)
        self._environment = register(self.log)
        path = library_path(
            folder, description.co_simulation.model_identifier, description.fmi_major
        )
        calling(name, "loading its library")
        self._library = load(path)
        returned()
        self._functions: dict[str, Any] = {}
        self._refuse_when_dead()
        calling(name, f"{self.prefix}Instantiate")
        self.handle = self._instantiate(folder, logging)
        returned()
        if not self.handle:
            raise FmuError(
                f"component {name}: FMU {description.name} could not be instantiated: "
                f"{self.log.reasons()}"
            )
        self._library.instances += 1

    prefix: str

    @abstractmethod
    def _instantiate(self, folder: Path, logging: bool) -> int | None: ...

    def address(self, name: str) -> int:
        """Address of the C function `name`, without its prefix ("SetReal")."""
        return self._library.address(self.prefix + name)

    def call(self, name: str, *arguments: Any, what: str = "") -> None:
        """Call the C function `name` of this instance; raise unless it succeeds."""
        self._refuse_when_dead()
        function = self._functions.get(name)
        if function is None:
            prototype = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, *map(type, arguments))
            function = self._functions[name] = prototype(self.address(name))
        calling(self.name, f"{self.prefix}{name}{what}")
        status = function(self.handle, *arguments)
        returned()
        self.check(status, name, what)

    def check(self, status: int, name: str, what: str = "") -> None:
        """Raise `FmuError` when `status` of function `name` is Discard, Error or Fatal."""
        if status in (0, 1):
            return
        if status == FATAL:
            self.mark_dead()
        label = STATUS_NAMES[status] if 0 <= status < len(STATUS_NAMES) else f"status {status}"
        raise FmuError(
            f"component {self.name}: {self.prefix}{name}{what} returned {label}: "
            f"{self.log.reasons()}"
        )

    def mark_dead(self) -> None:
        """Nothing of this FMU is called any more: Fatal corrupts all instances of a library."""
        self._library.corrupted = True

    @property
    def alive(self) -> bool:
        """Whether functions of this instance may be called."""
        return bool(self.handle) and not self._library.corrupted

    def _refuse_when_dead(self) -> None:
        if self._library.corrupted:
            raise FmuError(
                f"component {self.name}: its FMU reported Fatal before and cannot be called"
            )

    # life cycle

    @abstractmethod
    def enter_initialization_mode(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """Begin initialisation at `start_time` (s)."""

    def exit_initialization_mode(self) -> None:
        """End initialisation; the instance can do steps from now on."""
        self.call("ExitInitializationMode")

    def terminate(self) -> None:
        """End the simulation of this instance."""
        self.call("Terminate")

    def reset(self) -> None:
        """Bring the instance back to where it was after instantiation."""
        self.call("Reset")

    def free(self) -> None:
        """Free the instance; harmless when it is gone already."""
        if self.handle and not self._library.corrupted:
            function = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(self.address("FreeInstance"))
            calling(self.name, f"{self.prefix}FreeInstance")
            function(self.handle)
            returned()
            self._library.instances -= 1
        self.handle = None
        forget(self._environment)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.free()

    @abstractmethod
    def do_step(self, time: float, step: float) -> None:
        """Step from `time` by `step` (s)."""

    def asks_for_the_end(self) -> bool:
        """Whether a discarded step means that the FMU wishes the simulation to end."""
        return False

    # values

    @abstractmethod
    def accessor(self, variable: Variable) -> tuple[str, Any]:
        """Suffix of the get and set functions for a variable's type, and its C type."""

    def set(self, values: Mapping[str, Value | Sequence[float]]) -> None:
        """Set variables by name: a number, a boolean, a string, or the numbers of an array."""
        for name, value in values.items():
            variable = self.description.variable(name)
            suffix, ctype = self.accessor(variable)
            data = _c_array(variable, value, ctype, self.name)
            self._transfer(f"Set{suffix}", variable, data)

    def get(self, name: str) -> Any:
        """The value of a variable: a float, an int, a bool, a str, or an array of them."""
        variable = self.description.variable(name)
        suffix, ctype = self.accessor(variable)
        data = (ctype * variable.size)()
        self._transfer(f"Get{suffix}", variable, data)
        values = [_from_c(variable, item) for item in data]
        return values[0] if variable.size == 1 else np.array(values)

    def _transfer(self, function: str, variable: Variable, data: Any) -> None:
        reference = ctypes.c_uint32(variable.value_reference)
        sizes = [ctypes.c_size_t(variable.size)] if self.prefix == "fmi3" else []
        arguments = (ctypes.byref(reference), ctypes.c_size_t(1), ctypes.byref(data), *sizes)
        types = [
            ctypes.c_void_p,
            ctypes.c_size_t,
            ctypes.c_void_p,
            *(ctypes.c_size_t for _ in sizes),
        ]
        native = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, *types)(self.address(function))
        self._refuse_when_dead()
        what = f" of variable {variable.name!r}"
        calling(self.name, f"{self.prefix}{function}{what}")
        status = native(self.handle, *arguments)
        returned()
        self.check(status, function, what)

    # state

    def get_state(self) -> ctypes.c_void_p:
        """A snapshot of the whole FMU state; give it back with `free_state`."""
        state = ctypes.c_void_p()
        self.call("GetFMUState" if self.prefix == "fmi3" else "GetFMUstate", ctypes.pointer(state))
        return state

    def set_state(self, state: ctypes.c_void_p) -> None:
        """Return to a snapshot of this instance."""
        self.call("SetFMUState" if self.prefix == "fmi3" else "SetFMUstate", state)

    def free_state(self, state: ctypes.c_void_p) -> None:
        """Give a snapshot back."""
        self.call(
            "FreeFMUState" if self.prefix == "fmi3" else "FreeFMUstate", ctypes.pointer(state)
        )

    def serialized_state(self) -> bytes:
        """A snapshot as bytes, which outlives the process; raises `FmuError`."""
        state, size = self.get_state(), ctypes.c_size_t()
        try:
            self.call(f"Serialized{self._state}Size", state, ctypes.pointer(size))
            content = (ctypes.c_uint8 * size.value)()
            first = ctypes.cast(content, ctypes.c_void_p)
            self.call(f"Serialize{self._state}", state, first, size)
        finally:
            self.free_state(state)
        return bytes(content)

    def restore_state(self, content: bytes) -> None:
        """Return to a snapshot in bytes, of an instance of the same FMU; raises `FmuError`."""
        state, size = ctypes.c_void_p(), ctypes.c_size_t(len(content))
        first = ctypes.cast(ctypes.create_string_buffer(content, len(content)), ctypes.c_void_p)
        verb = "Deserialize" if self.prefix == "fmi3" else "DeSerialize"
        self.call(f"{verb}{self._state}", first, size, ctypes.pointer(state))
        try:
            self.set_state(state)
        finally:
            self.free_state(state)

    @property
    def _state(self) -> str:
        return "FMUState" if self.prefix == "fmi3" else "FMUstate"

    # derivatives

    def directional_derivative(
        self, unknowns: Sequence[str], known: str, seed: float = 1.0
    ) -> NDArray[np.float64]:
        """d(unknowns)/d(known) * seed, shape (len(unknowns),)."""
        references = (ctypes.c_uint32 * len(unknowns))(
            *(self.description.variable(name).value_reference for name in unknowns)
        )
        reference = ctypes.pointer(
            ctypes.c_uint32(self.description.variable(known).value_reference)
        )
        seeds, result = ctypes.pointer(ctypes.c_double(seed)), (ctypes.c_double * len(unknowns))()
        n, one = ctypes.c_size_t(len(unknowns)), ctypes.c_size_t(1)
        first, out = ctypes.cast(references, ctypes.c_void_p), ctypes.cast(result, ctypes.c_void_p)
        if self.prefix == "fmi3":
            sized = (first, n, reference, one, seeds, one, out, n)
            self.call("GetDirectionalDerivative", *sized)
        else:
            self.call("GetDirectionalDerivative", first, n, reference, one, seeds, out)
        return np.array(result)


def _c_array(variable: Variable, value: Any, ctype: Any, component: str) -> Any:
    items = list(value) if isinstance(value, (list, tuple, np.ndarray)) else [value]
    if len(items) != variable.size:
        raise FmuError(
            f"component {component}: variable {variable.name!r} has {variable.size} element(s), "
            f"but {len(items)} value(s) were given"
        )
    try:
        return (ctype * variable.size)(*(_to_c(variable, item) for item in items))
    except (TypeError, ValueError, KeyError) as fault:
        raise FmuError(
            f"component {component}: variable {variable.name!r} of type {variable.type} cannot be "
            f"set to {value!r}"
        ) from fault


def _to_c(variable: Variable, value: Any) -> Any:
    if variable.type in REAL_TYPES:
        return float(value)
    if variable.type in INTEGER_TYPES:
        if float(value) != int(value):
            raise ValueError(value)
        return int(value)
    if variable.type == "Boolean":
        return {"true": True, "false": False, "1": True, "0": False}[str(value).lower()]
    if variable.type == "String":
        return str(value).encode()
    raise TypeError(variable.type)


def _from_c(variable: Variable, item: Any) -> Any:
    if variable.type == "Boolean":
        return bool(item)
    if variable.type == "String":
        return (item or b"").decode("utf-8", "replace")
    return item
