"""One instance of a portable FMU of a block: the operations of `c/block.c` in Python.

Sample k is due at start + phase + k * sample time, counted in integer nanoseconds. A step over
[t, t + h) computes the samples that are due in it with the inputs as they stand; samples on the
end of the step belong to the next one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Model:
    """Tables of one block: sizes (inputs, outputs, parameters, states), `names` and `start` by
    value reference without time, which parameters are `tunable`, times in nanoseconds."""

    sizes: tuple[int, int, int, int]
    names: tuple[str, ...]
    start: tuple[float, ...]
    tunable: tuple[bool, ...]
    sample_time: int
    phase: int
    step: Callable[[Any, Any, Any, Any], None]


class StepError(Exception):
    """A step failed; the values are those before it. The message is for the log."""


class Instance:
    """The values of one instance."""

    def __init__(self, model: Model) -> None:
        """Start values throughout."""
        self._model = model
        self._values = np.array(model.start, dtype=float)
        self._samples = 0
        self._start = self._time = 0.0
        self._running = False

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        """Samples are counted from the start time on."""
        self._start = self._time = start_time

    def exit_initialization_mode(self) -> None:
        """From now on states are not set any more."""
        self._running = True

    def do_step(self, time: float, length: float) -> None:
        """Compute the samples that are due, or raise StepError and keep the values."""
        model = self._model
        begin = _nanoseconds(time - self._start)
        end = _nanoseconds(time + length - self._start)
        # a sample due within a thousandth before the end is meant to be at the end
        end -= min(end - begin, model.sample_time) // 1000
        trial, samples = self._values.copy(), self._samples
        n_u, n_y, n_p, _ = model.sizes
        u, y, p, x = np.split(trial, [n_u, n_u + n_y, n_u + n_y + n_p])
        while model.phase + samples * model.sample_time < end:
            with np.errstate(all="ignore"):
                model.step(p, x, u, y)
            for name, value in zip(model.names[n_u:], y, strict=False):
                if not isfinite(value):
                    due = self._start + (model.phase + samples * model.sample_time) * 1e-9
                    raise StepError(
                        f"The sample at {due:.12g} s failed: output {name!r} is {value}. The "
                        "values are those before the step."
                    )
            samples += 1
        self._values, self._samples, self._time = trial, samples, time + length

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values by value reference, 0 being time."""
        if unknown := [vr for vr in vrs if not 0 <= vr <= len(self._values)]:
            raise ValueError(f"There is no variable with value reference {unknown[0]}.")
        return [self._time if vr == 0 else float(self._values[vr - 1]) for vr in vrs]

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set inputs, tunable parameters, and states before the run; raises ValueError for
        anything else and changes nothing then."""
        for vr, value in zip(vrs, values, strict=True):
            self._check(vr, value)
        self._values[np.array(vrs, dtype=int) - 1] = values

    def _check(self, vr: int, value: float) -> None:
        n_u, n_y, n_p, n_x = self._model.sizes
        index = vr - 1
        if not 0 <= index < n_u + n_y + n_p + n_x:
            raise ValueError(f"Value reference {vr} cannot be set, it is calculated or unknown.")
        name = self._model.names[index]
        if not isfinite(value):
            raise ValueError(f"{name!r} cannot be set to {value}, values must be finite.")
        parameter = index - n_u - n_y
        if 0 <= parameter < n_p and not self._model.tunable[parameter]:
            raise ValueError(f"{name!r} cannot be set at all, it is part of the design.")
        if self._running and index >= n_u and not 0 <= parameter < n_p:
            raise ValueError(f"{name!r} cannot be set by value after initialization.")

    def get_state(self) -> dict[str, Any]:
        """Everything that a restored instance needs, ready for JSON."""
        return {
            "values": self._values.tolist(),
            "samples": self._samples,
            "start": self._start,
            "time": self._time,
            "running": self._running,
        }

    def set_state(self, state: dict[str, Any]) -> None:
        """Take over what `get_state` gave."""
        self._values = np.array(state["values"], dtype=float)
        self._samples, self._running = state["samples"], state["running"]
        self._start, self._time = state["start"], state["time"]


def _nanoseconds(seconds: float) -> int:
    """Halves away from zero, as C's llround."""
    scaled = abs(seconds) * 1e9
    whole = int(scaled + 0.5) if scaled < 2**52 else int(scaled)
    return whole if seconds >= 0 else -whole
