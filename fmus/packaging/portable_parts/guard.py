"""What stands between a bridge's library and an instance: no exception gets through.

The library turns every exception into Fatal, after which an importer may not even free the
instance. Here a refused call changes nothing, is written to the log, and fails the next step, which
the importer learns as a status that it can go on from.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from math import isfinite, nan
from typing import Any
from zlib import crc32

SLACK = 16 * 2.0**-52  # as in `life_cycle.c`


class Guard:
    """The `instance` of a plant or a block; `log` takes what is refused, as one line."""

    def __init__(self, instance: Any, log: Callable[[str], None]) -> None:
        """No fault is open."""
        self._instance = instance
        self._log = log
        self._fault: str | None = None
        self._start = self._time = 0.0

    def setup_experiment(self, start_time: float, *limits: float | None) -> None:
        """Start time, and what else the bridge passes on (stop time, tolerance)."""
        self._start = self._time = start_time
        self._attempt(self._instance.setup_experiment, start_time, *limits)

    def exit_initialization_mode(self) -> None:
        """The run begins."""
        self._attempt(self._instance.exit_initialization_mode)

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values by value reference, NaN where the call is refused."""
        found = self._attempt(self._instance.get_real, vrs)
        return [nan] * len(vrs) if found is None else list(found)

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set all of the values or none."""
        self._attempt(self._instance.set_real, vrs, values)

    def do_step(self, time: float, length: float) -> bool:
        """Whether the step was done; it fails for an open fault, too, and closes it."""
        if self._fault is not None:
            self._log(f"The step at {time!r} s fails, since a call before it was refused: "
                      f"{self._fault}")  # fmt: skip
            self._fault = None
            return False
        try:
            self._check_step(time, length)
            self._instance.do_step(time, length)
        except Exception as failure:
            self._log(str(failure))
            return False
        self._time = time + length
        return True

    def get_state(self) -> dict[str, Any]:
        """Everything that a restored instance needs, ready for JSON."""
        own = {"start": self._start, "time": self._time, "fault": self._fault}
        return {**own, "instance": self._instance.get_state()}

    def set_state(self, state: dict[str, Any]) -> None:
        """Take over what `get_state` gave."""

        def take() -> None:
            if "damaged" in state:
                raise ValueError(state["damaged"])
            self._instance.set_state(state["instance"])
            self._start, self._time, self._fault = (state[k] for k in ("start", "time", "fault"))

        self._attempt(take)

    def _check_step(self, time: float, length: float) -> None:
        if not (length > 0 and isfinite(length)):
            raise ValueError(f"The step size is {length!r} s, it must be above 0.")
        if not abs(time - self._time) <= SLACK * (abs(time) + abs(self._start) + length):
            raise ValueError(
                f"The step starts at {time!r} s, but the instance stands at {self._time!r} s."
            )

    def _attempt(self, call: Callable[..., Any], *arguments: Any) -> Any:
        """The call's result; None where it is refused, and the fault is kept."""
        try:
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
