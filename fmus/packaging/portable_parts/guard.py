"""What stands between a bridge's library and an instance: no exception gets through.

The library turns every exception into Fatal, after which an importer may not even free the
instance. Here a refused call changes nothing, is written to the log, and fails the next step, which
the importer learns as a status that it can go on from.

The libraries pass on calls in every state of the FMI state machine, so the state is held here.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from math import isfinite, nan
from typing import Any
from zlib import crc32

SLACK = 16 * 2.0**-52  # as in `life_cycle.c`

_MODES = ("instantiated", "initialization mode", "step mode", "terminated")
INSTANTIATED, INITIALIZATION, STEP, TERMINATED = _MODES
_OWN = ("start", "time", "mode", "fault")


class Guard:
    """The `instance` of a plant or a block; `log` takes what is refused, as one line."""

    def __init__(self, instance: Any, log: Callable[[str], None]) -> None:
        """No fault is open."""
        self._instance = instance
        self._log = log
        self._fault: str | None = None
        self._mode = INSTANTIATED
        self._start: float | None = None
        self._time = 0.0

    def setup_experiment(self, start_time: float, *limits: float | None) -> None:
        """Start time, and what else the bridge passes on (stop time, tolerance)."""
        self._attempt("SetupExperiment", (INSTANTIATED,), self._begin, start_time, *limits)

    def enter_initialization_mode(self) -> None:
        """From instantiated to initialization mode."""
        self._attempt("EnterInitializationMode", (INSTANTIATED,), self._move, INITIALIZATION)

    def exit_initialization_mode(self) -> None:
        """The run begins."""

        def leave() -> None:
            self._instance.exit_initialization_mode()
            self._move(STEP)

        self._attempt("ExitInitializationMode", (INITIALIZATION,), leave)

    def terminate(self) -> None:
        """The run ends; values are only read after it."""
        self._attempt("Terminate", (STEP,), self._move, TERMINATED)

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values by value reference, NaN where the call is refused."""
        found = self._attempt("Get", _MODES, self._instance.get_real, vrs)
        return [nan] * len(vrs) if found is None else list(found)

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set all of the values or none."""
        self._attempt("Set", _MODES[:-1], self._instance.set_real, vrs, values)

    def do_step(self, time: float, length: float) -> bool:
        """Whether the step was done; it fails for an open fault, too, and closes it."""
        if self._fault is not None:
            self._log(f"The step at {time!r} s fails, since a call before it was refused: "
                      f"{self._fault}")  # fmt: skip
            self._fault = None
            return False
        try:
            self._check_mode("DoStep", (STEP,))
            if self._start is None and isfinite(time):  # pythonfmu3 passes no start time on
                self._begin(time)
            self._check_step(time, length, self._start or 0.0)
            self._instance.do_step(time, length)
        except Exception as failure:
            self._log(str(failure))
            return False
        self._time = time + length
        return True

    def get_state(self) -> dict[str, Any]:
        """Everything that a restored instance needs, ready for JSON."""
        own = {name: getattr(self, f"_{name}") for name in _OWN}
        return {**own, "instance": self._instance.get_state()}

    def set_state(self, state: dict[str, Any]) -> None:
        """Take over what `get_state` gave."""

        def take() -> None:
            if "damaged" in state:
                raise ValueError(state["damaged"])
            self._instance.set_state(state["instance"])
            for name in _OWN:
                setattr(self, f"_{name}", state[name])

        self._attempt("SetFMUState", _MODES, take)

    def _begin(self, time: float, *limits: float | None) -> None:
        self._start = self._time = time
        self._instance.setup_experiment(time, *limits)

    def _move(self, mode: str) -> None:
        self._mode = mode

    def _check_mode(self, name: str, legal: tuple[str, ...]) -> None:
        if self._mode not in legal:
            raise ValueError(
                f"{name}: not allowed while the instance is in the state {self._mode!r}, "
                f"only in {' or '.join(map(repr, legal))}."
            )

    def _check_step(self, time: float, length: float, start: float) -> None:
        if not (length > 0 and isfinite(length)):
            raise ValueError(f"The step size is {length!r} s, it must be above 0.")
        if not abs(time - self._time) <= SLACK * (abs(time) + abs(start) + length):
            raise ValueError(
                f"The step starts at {time!r} s, but the instance stands at {self._time!r} s."
            )

    def _attempt(
        self, name: str, legal: tuple[str, ...], call: Callable[..., Any], *arguments: Any
    ) -> Any:
        """The result of the FMI function `name`; None where it is refused, and the fault is
        kept."""
        try:
            self._check_mode(name, legal)
            return call(*arguments)
        except Exception as fault:
            self._fault = self._fault or str(fault) or type(fault).__name__
            self._log(str(fault))
            return None


def state_to_bytes(state: dict[str, Any], token: str) -> bytes:
    """A stored state as bytes, with a checksum over it and the token of its FMU."""
    text = json.dumps(state).encode()
    return b"%08x" % crc32(text, crc32(token.encode())) + text


def state_from_bytes(data: bytes, token: str) -> dict[str, Any]:
    """The state again, or one that `Guard.set_state` refuses: this call itself cannot fail."""
    head, text = data[:8], data[8:]
    if head != b"%08x" % crc32(text, crc32(token.encode())):
        return {"damaged": f"The {len(data)} bytes are no state of this FMU, or are damaged."}
    state: dict[str, Any] = json.loads(text)
    return state
