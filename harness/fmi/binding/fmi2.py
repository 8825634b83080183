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
    MODEL_EXCHANGE,
    DiscreteStates,
    FmuInstance,
    InterfaceType,
    StepOutcome,
)
from harness.fmi.binding.logger import C_LIBRARY, variadic_logger
from harness.fmi.binding.mark import calling, returned
from harness.fmi.description.model_description import INTEGER_TYPES, REAL_TYPES

_PENDING = 5
_DO_STEP_STATUS, _LAST_SUCCESSFUL_TIME, _TERMINATED = 0, 2, 3  # of fmi2StatusKind
_FMI2_TYPES: dict[InterfaceType, int] = {MODEL_EXCHANGE: 0, CO_SIMULATION: 1}


PLAIN_TYPES: dict[str, tuple[str, Any]] = {
    **dict.fromkeys(REAL_TYPES, ("Real", ctypes.c_double)),
    **dict.fromkeys(INTEGER_TYPES, ("Integer", ctypes.c_int)),
    "Boolean": ("Boolean", ctypes.c_int), "String": ("String", ctypes.c_char_p),
}  # fmt: skip


def fields(ctype: Any, *names: str) -> tuple[tuple[str, Any], ...]:
    """The fields of a structure that are of one C type."""
    return tuple((name, ctype) for name in names)


class _Callbacks(ctypes.Structure):
    _fields_ = fields(
        ctypes.c_void_p, "logger", "allocate_memory", "free_memory", "step_finished", "environment"
    )


class _EventInfo(ctypes.Structure):
    _fields_ = (
        *fields(
            ctypes.c_int, "needs_update", "terminate", "nominals_changed", "values_changed", "timed"
        ),
        ("next_event_time", ctypes.c_double),
    )


@cache
def memory() -> tuple[int | None, int | None]:
    """Addresses of calloc and free, which FMUs of FMI 1 and 2 receive."""
    functions = (C_LIBRARY.calloc, C_LIBRARY.free)
    addresses = [ctypes.cast(function, ctypes.c_void_p).value for function in functions]
    return addresses[0], addresses[1]


class Fmi1Or2Instance(FmuInstance):
    """Steps and values of FMI 1.0 and 2.0."""

    def advance(self, time: float, step: float) -> StepOutcome:
        """DoStep without a state to return to; after Discard, how far it came."""
        arguments = (ctypes.c_double(time), ctypes.c_double(step), self.boolean(1))
        status = self._final(self.status("DoStep", *arguments))
        if status == DISCARD:
            reached = self.step_status(
                "GetRealStatus", _LAST_SUCCESSFUL_TIME, ctypes.c_double(time)
            )
            return StepOutcome(reached, False, self.asks_for_the_end(), True)
        self.check(status, "DoStep", f" at t = {time:.9g} s")
        return StepOutcome(time + step)

    def _final(self, status: int) -> int:
        """The status in which a step ends that an FMU does in the background (Pending)."""
        if status != _PENDING:
            return status
        kind, found = ctypes.c_int(_DO_STEP_STATUS), ctypes.pointer(ctypes.c_int(status))
        self.call("GetStatus", kind, found)
        calling(self.name, f"{self.symbol('GetStatus')} (the step is pending)")  # one long call
        while found.contents.value == _PENDING:
            sleep(1e-4)
            self.check(self._functions["GetStatus"](self.handle, kind, found), "GetStatus")
        returned()
        return found.contents.value

    def step_status(self, name: str, kind: int, otherwise: Any) -> Any:
        """What the FMU says of its last step, `otherwise` (of ctypes) where it does not know."""
        place = ctypes.pointer(otherwise)
        with suppress(FmuError):
            if self.offers(name):
                self.call(name, ctypes.c_int(kind), place)
                return place.contents.value
        return otherwise.value

    event_info: type[ctypes.Structure]

    def events(self, name: str, *arguments: Any) -> DiscreteStates:
        """Call a function whose last argument is event information, and what that says."""
        info = ctypes.pointer(self.event_info())
        self.call(name, *arguments, info)
        said: Any = info.contents
        return DiscreteStates(
            needs_update=bool(said.needs_update),
            terminate=bool(said.terminate),
            nominals_changed=bool(said.nominals_changed),
            values_changed=bool(said.values_changed),
            next_event_time=said.next_event_time if said.timed else None,
        )


class Fmi2Instance(Fmi1Or2Instance):
    """An instance of an FMI 2.0 FMU."""

    prefix, boolean, event_info, types = "fmi2", ctypes.c_int, _EventInfo, PLAIN_TYPES
    _told = False

    def _instantiate(self, folder: Path, logging: bool) -> int | None:
        s, i = ctypes.c_char_p, ctypes.c_int
        # lives as long as the instance
        self._callbacks = _Callbacks(variadic_logger(), *memory(), None, self._environment)
        callbacks = ctypes.c_void_p(ctypes.addressof(self._callbacks))
        named, token = s(self.name.encode()), s(self.description.token.encode())
        place = s((folder / "resources").as_uri().encode())
        kind = i(_FMI2_TYPES[self.interface_type])
        return self.create("Instantiate", named, kind, token, place, callbacks, i(0), i(logging))

    def enter_initialization_mode(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """fmi2EnterInitializationMode, after fmi2SetupExperiment where that is yet to come."""
        if not self._told:
            self.tell_experiment(start_time, stop_time, tolerance)
        self._told = False
        self.call("EnterInitializationMode")

    def tell_experiment(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """fmi2SetupExperiment."""
        self.call("SetupExperiment", *self.experiment(start_time, stop_time, tolerance))
        self._told = True

    def asks_for_the_end(self) -> bool:
        """fmi2GetBooleanStatus(fmi2Terminated), after a step that was discarded."""
        return bool(self.step_status("GetBooleanStatus", _TERMINATED, ctypes.c_int()))

    def update_discrete_states(self) -> DiscreteStates:
        """fmi2NewDiscreteStates."""
        return self.events("NewDiscreteStates")
