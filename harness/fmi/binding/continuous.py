"""The continuous part of an FMU in model exchange: time, states, derivatives, event indicators.

The functions are bound once and move numbers between the FMU and arrays of the caller without
copies, since a solver calls them very often. They return the status instead of raising: a solver
may take a smaller step after Discard.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.mark import calling, returned

_DERIVATIVES = ("GetDerivatives", "GetDerivatives", "GetContinuousStateDerivatives")
_NOMINALS = ("GetNominalContinuousStates", *["GetNominalsOfContinuousStates"] * 2)
"""What the functions are called in FMI 1, 2 and 3."""


class ContinuousPart:
    """Bound functions of an instance in model exchange with `nx` states and `nz` indicators."""

    def __init__(self, instance: FmuInstance) -> None:
        """Bind what the sizes call for; raises `FmuError` where a function is missing."""
        d = instance.description
        self.instance = instance
        self.nx, self.nz = d.number_of_continuous_states, d.number_of_event_indicators
        if d.fmi_major == 3:  # with the structural parameters in force
            self.nx = sum(instance.count(d.variable(rate)) for _, rate in d.states)
            self.nz = sum(instance.count(d.variable(name)) for name in d.event_indicators)
        version = d.fmi_major - 1
        self.set_time: Callable[[float], int] = self._bind("SetTime", ctypes.c_double)
        self.set_states = self._vector("SetContinuousStates", self.nx)
        self.get_states = self._vector("GetContinuousStates", self.nx)
        self.derivatives_name, self.nominals_name = _DERIVATIVES[version], _NOMINALS[version]
        self.get_derivatives = self._vector(self.derivatives_name, self.nx)
        self.get_indicators = self._vector("GetEventIndicators", self.nz)

    def _bind(self, name: str, *types: Any) -> Any:
        prototype = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, *types)
        function, handle = prototype(self.instance.address(name)), self.instance.handle
        component, call = self.instance.name, self.instance.symbol(name)

        def bound(*arguments: Any) -> int:
            calling(component, call)
            status: int = function(handle, *arguments)
            returned()
            return status

        return bound

    def _vector(self, name: str, size: int) -> Callable[[int], int]:
        """A function of the address of `size` doubles; it does nothing where there are none."""
        if size == 0:
            return lambda address: 0
        bound = self._bind(name, ctypes.c_void_p, ctypes.c_size_t)
        return lambda address: bound(address, size)

    def states(self) -> NDArray[np.float64]:
        """The continuous states, shape (nx,); raises `FmuError`."""
        return self._read(self.get_states, self.nx, "GetContinuousStates")

    def indicators(self) -> NDArray[np.float64]:
        """The event indicators, shape (nz,); raises `FmuError`."""
        return self._read(self.get_indicators, self.nz, "GetEventIndicators")

    def nominals(self) -> NDArray[np.float64]:
        """The nominal values of the states, shape (nx,): 1 where the FMU does not say."""
        nominal = np.abs(self.stated_nominals())
        return np.where(np.isfinite(nominal) & (nominal > 0.0), nominal, 1.0)

    def stated_nominals(self) -> NDArray[np.float64]:
        """The nominal values as the FMU states them, shape (nx,): legal or not."""
        name = self.nominals_name
        if self.nx and self.instance.offers(name):
            return self._read(self._vector(name, self.nx), self.nx, name, before=1.0)
        return np.ones(self.nx)

    def derivatives(self) -> NDArray[np.float64]:
        """The derivatives of the states, shape (nx,); raises `FmuError`."""
        return self._read(self.get_derivatives, self.nx, "Get(derivatives)")

    def _read(
        self, function: Callable[[int], int], size: int, name: str, before: float = 0.0
    ) -> NDArray[np.float64]:
        values = np.full(size, before)
        self.instance.check(function(values.ctypes.data), name)
        return values

    def move(self, time: float, x: NDArray[np.float64]) -> None:
        """Set time and states; raises `FmuError`."""
        check = self.instance.check
        check(self.set_time(time), "SetTime", f" to {time:.9g} s")
        check(self.set_states(x.ctypes.data), "SetContinuousStates", f" at t = {time:.9g} s")
