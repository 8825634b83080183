"""One instance of an FMU: its life cycle and its values, all versions of FMI alike.

Everything outside the loop goes through here, one ctypes call at a time; the loop itself takes
the addresses (`address`, `handle`) and calls them directly. Statuses are treated as the standard
says: Warning goes on, Discard and Error raise, after Fatal nothing is called any more, not even
free. What is particular to model exchange and to events is in `continuous.py` and `events.py`.
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from harness.errors import FmuError
from harness.fmi.binding.groups import Group
from harness.fmi.binding.interface import (
    CO_SIMULATION,
    MODEL_EXCHANGE,
    DiscreteStates,
    InterfaceType,
    StepOutcome,
    capabilities,
)
from harness.fmi.binding.library import library_path, load, mandatory_functions
from harness.fmi.binding.logger import LogMessage, MessageLog, forget, register, status_name
from harness.fmi.binding.mark import calling, returned
from harness.fmi.binding.values import Value, Values, from_c, opposite, to_c
from harness.fmi.description.model_description import ModelDescription, Variable
from harness.fmi.wording import shorten

__all__ = ["CO_SIMULATION", "MODEL_EXCHANGE", "DiscreteStates", "FmuInstance", "InterfaceType",
           "StepOutcome", "Value", "capabilities"]  # fmt: skip

DISCARD = 2
FATAL = 4


class FmuInstance(ABC):
    """An instantiated FMU; use as a context manager, or call `free`.

    `handle` is the component pointer, `log` the messages received so far, `notes` what the FMU did
    against the standard without harm.
    """

    def __init__(
        self,
        description: ModelDescription,
        folder: Path,
        name: str,
        *,
        interface_type: InterfaceType = CO_SIMULATION,
        event_mode: bool = False,
        early_return: bool = False,
        logging: bool = False,
        echo: Callable[[LogMessage], None] | None = None,
    ) -> None:
        """Load and instantiate; raises `FmuError` with what the FMU logged.

        `event_mode` and `early_return` are for FMI 3 co-simulation only.
        """
        self.capabilities = capabilities(description, interface_type)
        self.description = description
        self.name = name
        self.interface_type = interface_type
        self.event_mode, self.early_return = event_mode, early_return
        self.log = MessageLog(echo)
        path = library_path(folder, self.capabilities.model_identifier, description.fmi_major)
        calling(name, "loading its library")
        self._library = load(path)
        self._library.component = name
        self._library.require(mandatory_functions(description.fmi_major, interface_type))
        returned()
        self._functions: dict[str, Any] = {}
        self._refuse_when_dead()
        self.notes: list[str] = []
        self._compare_version()
        known_as = name if description.fmi_major == 1 else ""
        self._environment = register(self.log, known_as, logging=logging)
        calling(name, f"{self.prefix}Instantiate")
        self.handle = self._instantiate(folder, logging)
        returned()
        if not self.handle:
            self.free()
            raise FmuError(
                f"component {name}: FMU {description.name} could not be instantiated: "
                f"{self.log.reasons()}"
            )
        self._library.instances += 1

    def _compare_version(self) -> None:
        """A library of another version of FMI than the description is noted."""
        if self.offers("GetVersion"):
            calling(self.name, f"{self.prefix}GetVersion")
            said = ctypes.CFUNCTYPE(ctypes.c_char_p)(self.address("GetVersion"))() or b""
            returned()
            version = said.decode("utf-8", "replace")
            if version.partition(".")[0] != str(self.description.fmi_major):
                self.notes.append(
                    f"component {self.name}: its library says that it is of FMI "
                    f"{shorten(version)!r}, its description that it is of FMI "
                    f"{self.description.fmi_version}"
                )

    tried: Callable[..., int] | None = None
    """What the next doStep came to that compiled code has called already; given its arguments."""
    prefix: str
    boolean: Any
    """The C type of a boolean."""

    @abstractmethod
    def _instantiate(self, folder: Path, logging: bool) -> int | None: ...

    def create(self, name: str, *arguments: Any) -> int | None:
        """Call the C function `name`, which makes an instance; its address, None where it fails."""
        prototype = ctypes.CFUNCTYPE(ctypes.c_void_p, *map(type, arguments))
        handle: int | None = prototype(self.address(name))(*arguments)
        return handle

    def symbol(self, name: str) -> str:
        """The full name of the C function `name`."""
        return self.prefix + name

    def address(self, name: str) -> int:
        """Address of the C function `name`, without its prefix ("SetReal")."""
        return self._library.address(self.symbol(name))

    def offers(self, name: str) -> bool:
        """Whether the library has the C function `name`; many FMUs leave out what is optional."""
        return self._library.find(self.symbol(name)) is not None

    def call(self, name: str, *arguments: Any, what: str = "") -> None:
        """Call the C function `name` of this instance; raise unless it succeeds."""
        self.check(self.status(name, *arguments, what=what), name, what)

    def status(self, name: str, *arguments: Any, what: str = "") -> int:
        """Call the C function `name` of this instance; its status."""
        self._refuse_when_dead()
        if name == "DoStep" and self.tried is not None:
            tried, self.tried = self.tried, None
            return tried(*arguments)
        function = self._functions.get(name)
        if function is None:
            prototype = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, *map(type, arguments))
            function = self._functions[name] = prototype(self.address(name))
        calling(self.name, f"{self.prefix}{name}{what}")
        status: int = function(self.handle, *arguments)
        returned()
        return status

    def check(self, status: int, name: str, what: str = "") -> None:
        """Raise `FmuError` when `status` of function `name` is Discard, Error or Fatal."""
        if status in (0, 1):
            return
        if status == FATAL:
            self.mark_dead()
        raise FmuError(
            f"component {self.name}: {self.symbol(name)}{what} returned {status_name(status)}: "
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

    def tell_experiment(  # noqa: B027  # FMI 1 and 3 have no such call
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """In FMI 2 the times are told by a call of its own, after which FMUs may forget what was
        set before: to be called before start values are set."""

    @abstractmethod
    def enter_initialization_mode(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """Begin initialisation at `start_time` (s)."""

    def experiment(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> tuple[Any, ...]:
        """The arguments that tell an FMU of FMI 2 or 3 its tolerance and times."""
        return (
            self.boolean(tolerance is not None),
            ctypes.c_double(tolerance or 0.0),
            ctypes.c_double(start_time),
            self.boolean(stop_time is not None),
            ctypes.c_double(stop_time or 0.0),
        )

    def exit_initialization_mode(self) -> None:
        """End initialisation; the instance can do steps from now on."""
        self.call("ExitInitializationMode")

    def terminate(self) -> None:
        """End the simulation of this instance."""
        self.call("Terminate")

    def reset(self) -> None:
        """Bring the instance back to where it was after instantiation."""
        self.call("Reset")

    free_function = "FreeInstance"

    def free(self) -> None:
        """Free the instance; harmless when it is gone already."""
        if self.handle and not self._library.corrupted:
            function = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(self.address(self.free_function))
            calling(self.name, f"{self.prefix}{self.free_function}")
            function(self.handle)
            returned()
            self._library.instances -= 1
        self.handle = None
        forget(self.log)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.free()

    def do_step(self, time: float, step: float) -> None:
        """Step from `time` by `step` (s); raises `FmuError` unless the whole step was done."""
        outcome = self.advance(time, step)
        if outcome.discarded:
            self.check(DISCARD, "DoStep", f" at t = {time:.9g} s")

    @abstractmethod
    def advance(self, time: float, step: float) -> StepOutcome:
        """Step from `time` by `step` (s), and say how far it came; raises `FmuError`."""

    def asks_for_the_end(self) -> bool:
        """Whether a discarded step means that the FMU wishes the simulation to end."""
        return False

    # events

    def enter_event_mode(self) -> None:
        """Stop the continuous part; inputs of all kinds may be set, events are handled."""
        self.call("EnterEventMode")

    @abstractmethod
    def update_discrete_states(self) -> DiscreteStates:
        """One iteration of event handling."""

    # values

    types: ClassVar[Mapping[str, tuple[str, Any]]]
    """Suffix of the get and set functions of each type of variables, and its C type."""

    def group(self, *variables: Variable) -> Group:
        """Variables of one type, to be read or set together; raises `FmuError`."""
        kind = variables[0].type
        if kind not in self.types:
            raise FmuError(
                f"variable {variables[0].name!r} has type {kind}, unknown in FMI "
                f"{self.description.fmi_major}"
            )
        suffix, ctype = self.types[kind]
        sized = self.prefix == "fmi3" and suffix != "Clock"
        count = sum(map(self.count, variables))
        group = Group(self.call, suffix, ctype, variables, count, sized=sized)
        group.tell = self._note
        return group

    def _note(self, what: str) -> None:
        note = f"component {self.name}: {what}"
        if note not in self.notes:
            self.notes.append(note)

    def shape(self, variable: Variable) -> tuple[int, ...]:
        """The sizes of an array with the structural parameters in force; () for a scalar."""
        return self.description.sizes(variable)

    def count(self, variable: Variable) -> int:
        """The number of elements of a variable."""
        return int(np.prod(self.shape(variable), dtype=np.int64))

    def set(self, values: Mapping[str, Values]) -> None:
        """Set variables by name: a number, a boolean, a string, bytes, or those of an array."""
        for name, value in values.items():
            variable = self.description.variable(name)
            group = self.group(variable)
            if variable.details.negated:
                value = opposite(variable, value)
            ctype = self.types[variable.type][1]
            group.write(to_c(variable, value, ctype, self.count(variable), self.name))

    def get(self, name: str) -> Any:
        """The value of a variable: a float, an int, a bool, a str, bytes, or an array of them."""
        variable = self.description.variable(name)
        value = from_c(variable, self.group(variable).read(), self.shape(variable))
        return opposite(variable, value) if variable.details.negated else value

    # state

    def get_state(self, state: ctypes.c_void_p | None = None) -> ctypes.c_void_p:
        """A snapshot of the whole FMU state, in the place of an older one where `state` is given;
        give it back with `free_state`."""
        state = ctypes.c_void_p() if state is None else state
        self.call(f"Get{self._state}", ctypes.pointer(state))
        return state

    def set_state(self, state: ctypes.c_void_p) -> None:
        """Return to a snapshot of this instance."""
        self.call(f"Set{self._state}", state)

    def free_state(self, state: ctypes.c_void_p) -> None:
        """Give a snapshot back."""
        self.call(f"Free{self._state}", ctypes.pointer(state))

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
        references = [self.description.variable(n).value_reference for n in (*unknowns, known)]
        rows, column = np.array(references[:-1], np.uint32), np.array(references[-1:], np.uint32)
        seeds, result = np.array([seed]), np.zeros(len(unknowns))
        n, one = ctypes.c_size_t(len(unknowns)), ctypes.c_size_t(1)
        of, by, scale, out = (
            ctypes.c_void_p(array.ctypes.data) for array in (rows, column, seeds, result)
        )
        sized = self.prefix == "fmi3"
        arguments = (scale, one, out, n) if sized else (scale, out)
        self.call("GetDirectionalDerivative", of, n, by, one, *arguments)
        return result
