"""SUNDIALS' CVODE (BDF, dense Newton, root finding), set up so that compiled code drives it.

The libraries are those that FMPy ships. Compiled callbacks evaluate the FMU; what is called in a
step is called by the addresses in the context.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.errors import SimulationError
from harness.participants import context as x
from harness.participants.context import Context
from harness.participants.model_exchange.equations import callbacks

_MOST_ATTEMPTS = 10_000
_FUNCTIONS = {
    x.STEP: "CVode", x.SET_STOP: "CVodeSetStopTime", x.RESTART: "CVodeReInit",
    x.BETWEEN: "CVodeGetDky",
}  # fmt: skip


class Cvode:
    """One integration; the vectors X, X_AT and ABSOLUTE of the context are the solver's own."""

    def __init__(
        self, context: Context, time: float, states: NDArray[np.float64],
        absolute: NDArray[np.float64], jacobian: bool,
    ) -> None:  # fmt: skip
        """Begin at `time` with `states`; tolerances RELATIVE and `absolute` (shape (n,))."""
        from fmpy import sundials as s

        self._s, self.message, n = s, "", len(states)
        library = s.libraries.sundials_cvode
        self._library = library
        self._context = s.SUNContext()
        s.SUNContext_Create(s.SUN_COMM_NULL, ctypes.byref(self._context))
        self._report = s.SUNErrHandlerFn(self._error)
        s.libraries.sundials_core.SUNContext_ClearErrHandlers(self._context)
        s.SUNContext_PushErrHandler(self._context, self._report, None)
        vectors = [self._vector(values) for values in (states, states, absolute, states, states)]
        state, between, tolerance, self._weights, self._errors = vectors
        self._vectors = vectors
        self._memory = ctypes.c_void_p(s.CVodeCreate(s.CV_BDF, self._context))
        self._callbacks = callbacks()
        rhs, roots, derivatives = (one.address for one in self._callbacks)
        memory, pointer = self._memory, ctypes.c_void_p
        self._do("CVodeInit", memory, pointer(rhs), ctypes.c_double(time), state)
        self._do("CVodeSetUserData", memory, pointer(context.address))
        relative = ctypes.c_double(float(context.reals[x.RELATIVE]))
        self._do("CVodeSVtolerances", memory, relative, tolerance)
        if context.cells[x.NZ]:
            n_roots = ctypes.c_int(int(context.cells[x.NZ]))
            self._do("CVodeRootInit", memory, n_roots, pointer(roots))
            self._do("CVodeSetNoInactiveRootWarn", memory)
        self._matrix = s.SUNDenseMatrix(n, n, self._context)
        self._solver = s.SUNLinSol_Dense(state, self._matrix, self._context)
        self._do("CVodeSetLinearSolver", memory, self._solver, self._matrix)
        if jacobian:
            self._do("CVodeSetJacFn", memory, pointer(derivatives))
        self._do("CVodeSetMaxStep", memory, ctypes.c_double(float(context.reals[x.LARGEST])))
        self._do("CVodeSetMaxNumSteps", memory, ctypes.c_long(_MOST_ATTEMPTS))
        self._bind(context, state, between, tolerance)

    def _bind(self, context: Context, state: Any, between: Any, tolerance: Any) -> None:
        for place, name in _FUNCTIONS.items():
            function = getattr(self._library, name)
            context.cells[place] = ctypes.cast(function, ctypes.c_void_p).value or 0
        context.cells[x.MEMORY] = self._memory.value or 0
        for place, vector in ((x.VECTOR, state), (x.VECTOR_AT, between), (x.TOLERANCES, tolerance)):
            context.cells[place] = ctypes.cast(vector, ctypes.c_void_p).value or 0
        for place, vector in ((x.X, state), (x.X_AT, between), (x.ABSOLUTE, tolerance)):
            data = ctypes.cast(self._s.NV_DATA_S(vector), ctypes.c_void_p)
            context.cells[place] = data.value or 0

    def _vector(self, values: NDArray[np.float64]) -> Any:
        vector = self._s.N_VNew_Serial(len(values), self._context)
        self._view(vector, len(values))[:] = values
        return vector

    def _view(self, vector: Any, n: int) -> NDArray[np.float64]:
        return np.ctypeslib.as_array(self._s.NV_DATA_S(vector), (n,))

    def _error(self, line: int, function: Any, file: Any, message: Any, code: int, *_: Any) -> None:
        self.message = (message or b"").decode("utf-8", "replace")

    def _do(self, name: str, *arguments: Any) -> None:
        function = self._library[name]  # not that of FMPy, which has prototypes of its own
        function.restype = ctypes.c_int
        flag = function(*(ctypes.c_void_p(a) if isinstance(a, int) else a for a in arguments))
        if flag < 0:
            raise SimulationError(f"the solver CVODE failed in {name} ({flag}): {self.message}")

    def worst_state(self, n: int) -> int:
        """The number of the state whose estimated error is the largest of its tolerance."""
        for name, vector in (
            ("CVodeGetErrWeights", self._weights), ("CVodeGetEstLocalErrors", self._errors),
        ):  # fmt: skip
            self._do(name, self._memory, vector)
        sizes = np.abs(self._view(self._weights, n) * self._view(self._errors, n))
        return int(np.nanargmax(sizes)) if np.isfinite(sizes).any() else 0

    def close(self) -> None:
        """Give the solver's memory back."""
        if not self._memory:
            return
        core, s = self._s.libraries.sundials_core, self._s
        s.CVodeFree(ctypes.byref(self._memory))
        for free, thing in ((core.SUNLinSolFree, self._solver), (core.SUNMatDestroy, self._matrix)):
            free(ctypes.cast(thing, ctypes.c_void_p))
        for vector in self._vectors:
            s.N_VDestroy_Serial(vector)
        core.SUNContext_Free(ctypes.byref(self._context))
        self._memory = ctypes.c_void_p()
