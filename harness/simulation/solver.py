"""What a solver for model exchange is to the one who drives it, and the simplest: Euler's method.

A solver keeps the states `x` in its own memory. `f` and `g` fill memory at an address and return
0, a positive number to ask for a smaller step, or a negative one to end.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from harness.errors import SimulationError
from harness.participants.grid import Grid, is_close

Array = NDArray[np.float64]
Derivatives = Callable[[float, int, int], int]
"""f(t, address of the states, address of the derivatives)"""
Indicators = Callable[[float, int, int], int]
"""g(t, address of the states, address of the event indicators)"""


class Solver(Protocol):
    """One integration; times in s."""

    x: Array

    def step(self, stop: float) -> tuple[float, bool]:
        """One step that does not pass `stop`: the time reached, and whether an indicator changed
        its sign."""

    def at(self, time: float) -> Array:
        """The states at a `time` within the last step."""

    def restart(self, time: float, x: Array, absolute: Array | None = None) -> None:
        """Begin anew at `time` with states `x`, after an event."""

    def close(self) -> None:
        """Give memory back."""


class Euler:
    """Steps of fixed size by x + h f(t, x); state events are seen at the end of a step.

    For checks against tools with the same method and step; it neither controls its error nor
    locates events.
    """

    def __init__(
        self, f: Derivatives, g: Indicators, n_roots: int, time: float, x: Array, size: float
    ) -> None:
        """Begin at `time` with steps of `size` (s)."""
        self._f, self._g, self._time, self._start = f, g, time, time
        self._grid = Grid.of(time, size)
        self.x, self._before, self._rates = x.copy(), x.copy(), np.zeros(len(x))
        self._signs = np.zeros(n_roots)
        self._fresh = True

    def step(self, stop: float) -> tuple[float, bool]:
        """To the next instant of the grid, or a shorter step that ends at `stop`."""
        if self._fresh:
            self._signs = self._indicators()
            self._fresh = False
        self._before[:] = self.x
        self._start = self._time
        self._check(self._f(self._time, self.x.ctypes.data, self._rates.ctypes.data))
        target = self._grid.after(self._time)
        near = is_close(target, stop, float(self._grid.step))
        self._time = stop if near else min(target, stop)
        self.x += (self._time - self._start) * self._rates
        signs = self._indicators()
        root = bool(np.any((self._signs > 0.0) != (signs > 0.0)))
        self._signs = signs
        return self._time, root

    def _indicators(self) -> Array:
        z = np.zeros(len(self._signs))
        if len(z):
            self._check(self._g(self._time, self.x.ctypes.data, z.ctypes.data))
        return z

    def _check(self, flag: int) -> None:
        if flag:
            raise SimulationError("Euler's method cannot go on: the FMU refused an evaluation")

    def at(self, time: float) -> Array:
        """The states at a `time` within the last step, on the line between its ends."""
        return np.asarray(self._before + (time - self._start) * self._rates)

    def restart(self, time: float, x: Array, absolute: Array | None = None) -> None:
        """Begin anew at `time` with states `x`."""
        self._time, self._fresh = time, True
        self.x[:] = x

    def close(self) -> None:
        """Nothing is held."""
