"""SUNDIALS' CVODE (BDF, dense Newton, root finding) by ctypes, one internal step at a time.

The libraries and the prototypes are those that FMPy ships. Stepping internally, instead of from
output to output, lets the caller tell the FMU of every accepted step, and a stop time keeps the
solver from looking beyond a time event. This module knows nothing of FMUs: `f` and `g` fill memory
at an address and return 0, a positive number to ask for a smaller step, or a negative one to end.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import SimulationError
from harness.simulation.solver import Derivatives, Indicators

_ONE_STEP, _ROOT_RETURN = 2, 2
_MOST_ATTEMPTS = 10_000


class Cvode:
    """An integration of `x` from `time`; `x` (shape (n,)) is the solver's own memory."""

    def __init__(
        self, f: Derivatives, g: Indicators, n_roots: int, time: float, x: NDArray[np.float64],
        relative: float, absolute: NDArray[np.float64], largest_step: float,
    ) -> None:  # fmt: skip
        """Set up; tolerances relative and absolute (shape (n,)); `largest_step` in s."""
        from fmpy import sundials as s

        self._s, self._message = s, ""
        self._context = s.SUNContext()
        s.SUNContext_Create(s.SUN_COMM_NULL, ctypes.byref(self._context))
        self._report = s.SUNErrHandlerFn(self._error)
        self._library = s.libraries.sundials_cvode
        s.libraries.sundials_core.SUNContext_ClearErrHandlers(self._context)
        s.SUNContext_PushErrHandler(self._context, self._report, None)
        self._vector, self.x = self._new(x)
        self._tolerance, self._absolute = self._new(absolute)
        self._relative = relative
        self._memory = ctypes.c_void_p(s.CVodeCreate(s.CV_BDF, self._context))
        self._rhs = s.CVRhsFn(lambda t, y, dy, _: f(t, _address(s, y), _address(s, dy)))
        self._root = s.CVRootFn(
            lambda t, y, z, _: g(t, _address(s, y), ctypes.cast(z, ctypes.c_void_p).value or 0)
        )
        self._do("CVodeInit", s.CVodeInit(self._memory, self._rhs, time, self._vector))
        self._set_tolerances()
        if n_roots:
            self._do("CVodeRootInit", s.CVodeRootInit(self._memory, n_roots, self._root))
            s.CVodeSetNoInactiveRootWarn(self._memory)
        self._matrix = s.SUNDenseMatrix(len(x), len(x), self._context)
        self._solver = s.SUNLinSol_Dense(self._vector, self._matrix, self._context)
        self._do(
            "CVodeSetLinearSolver", s.CVodeSetLinearSolver(self._memory, self._solver, self._matrix)
        )
        s.CVodeSetMaxStep(self._memory, largest_step)
        s.CVodeSetMaxNumSteps(self._memory, _MOST_ATTEMPTS)
        self._stop = self._library.CVodeSetStopTime
        self._stop.argtypes, self._stop.restype = [ctypes.c_void_p, ctypes.c_double], ctypes.c_int
        self._dky = self._library.CVodeGetDky
        self._dky.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_int, s.N_Vector]
        self._dky.restype = ctypes.c_int
        self._between, self._between_x = self._new(x)

    def _new(self, values: NDArray[np.float64]) -> tuple[Any, NDArray[np.float64]]:
        vector = self._s.N_VNew_Serial(len(values), self._context)
        view = np.ctypeslib.as_array(self._s.NV_DATA_S(vector), (len(values),))
        view[:] = values
        return vector, view

    def _error(self, line: int, function: Any, file: Any, message: Any, code: int, *_: Any) -> None:
        self._message = (message or b"").decode("utf-8", "replace")

    def _do(self, function: str, flag: int) -> None:
        if flag < 0:
            raise SimulationError(
                f"the solver CVODE failed in {function} ({flag}): {self._message}"
            )

    def _set_tolerances(self) -> None:
        flag = self._s.CVodeSVtolerances(self._memory, self._relative, self._tolerance)
        self._do("CVodeSVtolerances", flag)

    def step(self, stop: float) -> tuple[float, bool]:
        """One accepted internal step that does not pass `stop` (s): the time reached and whether
        an indicator changed its sign there. `x` holds the states at that time."""
        self._do("CVodeSetStopTime", self._stop(self._memory, stop))
        reached = ctypes.c_double()
        flag = self._s.CVode(self._memory, stop, self._vector, ctypes.byref(reached), _ONE_STEP)
        self._do("CVode", flag)
        return reached.value, flag == _ROOT_RETURN

    def at(self, time: float) -> NDArray[np.float64]:
        """The states (shape (n,)) at a `time` within the last step, by the method's polynomial."""
        self._do("CVodeGetDky", self._dky(self._memory, time, 0, self._between))
        return self._between_x

    def restart(
        self, time: float, x: NDArray[np.float64], absolute: NDArray[np.float64] | None = None
    ) -> None:
        """Begin anew at `time` with states `x`, after an event."""
        self.x[:] = x
        if absolute is not None:
            self._absolute[:] = absolute
            self._set_tolerances()
        self._do("CVodeReInit", self._s.CVodeReInit(self._memory, time, self._vector))

    def close(self) -> None:
        """Give the solver's memory back."""
        if not self._memory:
            return
        core, s = self._s.libraries.sundials_core, self._s
        s.CVodeFree(ctypes.byref(self._memory))
        for free, thing in ((core.SUNLinSolFree, self._solver), (core.SUNMatDestroy, self._matrix)):
            free(ctypes.cast(thing, ctypes.c_void_p))
        for vector in (self._vector, self._tolerance, self._between):
            s.N_VDestroy_Serial(vector)
        core.SUNContext_Free(ctypes.byref(self._context))
        self._memory = ctypes.c_void_p()


def _address(s: Any, vector: Any) -> int:
    return ctypes.cast(s.NV_DATA_S(vector), ctypes.c_void_p).value or 0
