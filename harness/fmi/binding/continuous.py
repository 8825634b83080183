"""The continuous part of an FMU in model exchange, one call at a time: states, derivatives, event
indicators, nominal values. A solver calls the same functions by address."""

from __future__ import annotations

import ctypes

import numpy as np
from numpy.typing import NDArray

from harness.fmi.binding.instance import FmuInstance

_DERIVATIVES = ("GetDerivatives", "GetDerivatives", "GetContinuousStateDerivatives")
_NOMINALS = ("GetNominalContinuousStates", *["GetNominalsOfContinuousStates"] * 2)
"""What the functions are called in FMI 1, 2 and 3."""


class ContinuousPart:
    """An instance in model exchange with `nx` states and `nz` indicators; all methods raise
    `FmuError`."""

    def __init__(self, instance: FmuInstance) -> None:
        """Find the sizes, and what the functions are called."""
        d = instance.description
        self.instance = instance
        self.nx, self.nz = d.number_of_continuous_states, d.number_of_event_indicators
        if d.fmi_major == 3:  # with the structural parameters in force
            self.nx = sum(instance.count(d.variable(rate)) for _, rate in d.states)
            self.nz = sum(instance.count(d.variable(name)) for name in d.event_indicators)
        version = d.fmi_major - 1
        self.derivatives_name, self.nominals_name = _DERIVATIVES[version], _NOMINALS[version]

    def states(self) -> NDArray[np.float64]:
        """The continuous states, shape (nx,)."""
        return self._call("GetContinuousStates", np.zeros(self.nx))

    def set_states(self, states: NDArray[np.float64]) -> None:
        """Set the continuous states, shape (nx,)."""
        self._call("SetContinuousStates", states)

    def derivatives(self) -> NDArray[np.float64]:
        """The derivatives of the states, shape (nx,)."""
        return self._call(self.derivatives_name, np.zeros(self.nx))

    def indicators(self) -> NDArray[np.float64]:
        """The event indicators, shape (nz,)."""
        return self._call("GetEventIndicators", np.zeros(self.nz))

    def nominals(self) -> NDArray[np.float64]:
        """The nominal values of the states, shape (nx,): 1 where the FMU does not say."""
        nominal = np.abs(self.stated_nominals())
        return np.where(np.isfinite(nominal) & (nominal > 0.0), nominal, 1.0)

    def stated_nominals(self) -> NDArray[np.float64]:
        """The nominal values as the FMU states them, shape (nx,): legal or not."""
        values = np.ones(self.nx)
        offered = self.instance.offers(self.nominals_name)
        return self._call(self.nominals_name, values) if offered else values

    def _call(self, name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Let a function read or fill an array; nothing is called where it has no elements."""
        if values.size:
            pointer = ctypes.c_void_p(values.ctypes.data)
            self.instance.call(name, pointer, ctypes.c_size_t(values.size))
        return values
