"""Solvers on one plant's equations as its FMU evaluates them: what `work_precision` compares.

`c/work_precision.c` is compiled with the FMU's sources by the FMU's compiler and flags. Rodas5P,
RODAS4 and CVODE run in it; scipy's Radau calls the same right-hand side and Jacobian from Python.
"""

from __future__ import annotations

import ctypes
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import sundials as s
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from benchmarks.lag import SOURCES
from benchmarks.stepper import Stepped
from fmus.packaging.compiler import compile_library, find_compiler
from fmus.packaging.plant.codegen import source_files
from fmus.packaging.plant.expressions import plant_expressions
from fmus.plant import Plant

Array = NDArray[np.float64]
_MAIN = "work_precision.c"
_FUNCTIONS = ("CVodeReInit", "CVodeSetStopTime", "CVode")


@dataclass(frozen=True, eq=False)
class Solvers:
    """A plant's library; every method takes inputs (N, n_u), each row held for `step` seconds."""

    plant: Plant
    library: Any

    @classmethod
    def of(cls, plant: Plant, folder: Path) -> Solvers:
        """Compile into `folder`; needs a C compiler."""
        compiler = find_compiler()
        if compiler is None:
            raise SystemExit("no C compiler; install one")
        sources = folder / plant.name
        sources.mkdir()
        for name, text in source_files(plant_expressions(plant), 3, "").items():
            (sources / name).write_bytes(text)
        (sources / _MAIN).write_bytes((SOURCES / _MAIN).read_bytes())
        library = sources / "work_precision.so"
        compile_library(compiler, sources, _MAIN, library, 3)
        return cls(plant, ctypes.CDLL(str(library)))

    @property
    def start(self) -> Array:
        """Start values of the states, (n_x,)."""
        return np.array([state.start for state in self.plant.states])

    @property
    def nominal(self) -> Array:
        """Nominal values of the states, (n_x,)."""
        return np.array([state.nominal for state in self.plant.states])

    def rosenbrock(
        self, order: int, tolerance: float, step: float, inputs: Array, start: Array | None = None
    ) -> Stepped:
        """Rodas5P of the FMU (order 5) or RODAS4 (order 4)."""
        x = (self.start if start is None else start).copy()
        states, nanoseconds = np.zeros((len(inputs), len(x))), np.zeros(len(inputs))
        failed = self.library.rosenbrock(
            order, ctypes.c_double(tolerance), ctypes.c_double(step), len(inputs),
            *map(_data, (inputs, x, states, nanoseconds)),
        )  # fmt: skip
        self._check(failed, f"the Rosenbrock method of order {order}")
        return Stepped(nanoseconds, states)

    def cvode(self, tolerance: float, step: float, inputs: Array) -> Stepped:
        """SUNDIALS' CVODE (BDF, dense, exact Jacobian), begun anew with each row."""
        n = len(self.plant.states)
        context, core = s.SUNContext(), s.libraries.sundials_core
        s.SUNContext_Create(s.SUN_COMM_NULL, ctypes.byref(context))
        vector, absolute = s.N_VNew_Serial(n, context), s.N_VNew_Serial(n, context)
        np.ctypeslib.as_array(s.NV_DATA_S(vector), (n,))[:] = self.start
        np.ctypeslib.as_array(s.NV_DATA_S(absolute), (n,))[:] = tolerance * self.nominal
        memory = ctypes.c_void_p(s.CVodeCreate(s.CV_BDF, context))
        cvode = s.libraries.sundials_cvode
        matrix = ctypes.c_void_p(s.SUNDenseMatrix(n, n, context))
        linear = ctypes.c_void_p(s.SUNLinSol_Dense(vector, matrix, context))
        for name, *arguments in (
            ("CVodeInit", ctypes.cast(self.library.cvode_rhs, ctypes.c_void_p), _REAL(0.0), vector),
            ("CVodeSVtolerances", _REAL(tolerance), absolute),
            ("CVodeSetLinearSolver", linear, matrix),
            ("CVodeSetJacFn", ctypes.cast(self.library.cvode_jacobian, ctypes.c_void_p)),
            ("CVodeSetMaxNumSteps", ctypes.c_long(1_000_000)),
        ):
            if cvode[name](memory, *arguments) != 0:
                raise SystemExit(f"{self.plant.name}: {name} failed")
        functions = [
            core.N_VGetArrayPointer,
            s.libraries.sundials_sunmatrixdense.SUNDenseMatrix_Data,
        ]
        functions += [cvode[name] for name in _FUNCTIONS]
        bound = (memory, vector, *functions)
        addresses = (ctypes.c_void_p * 7)(*(ctypes.cast(f, ctypes.c_void_p) for f in bound))
        self.library.use_sundials(addresses)
        states, nanoseconds = np.zeros((len(inputs), n)), np.zeros(len(inputs))
        failed = self.library.cvode(
            _REAL(step), len(inputs), *map(_data, (inputs, states, nanoseconds))
        )
        s.CVodeFree(ctypes.byref(memory))
        self._check(failed, "CVODE")
        return Stepped(nanoseconds, states)

    def radau(self, tolerance: float, step: float, inputs: Array) -> Stepped:
        """scipy's Radau (exact Jacobian), begun anew with each row; with the time of Python."""
        n, rows, times = len(self.plant.states), [self.start], []
        dx, matrix = np.zeros(n), np.zeros((n, n))

        def rate(_t: float, x: Array) -> Array:
            self.library.rhs(_data(np.ascontiguousarray(x)), _data(dx))
            return dx.copy()

        def slopes(_t: float, x: Array) -> Array:
            self.library.jacobian(_data(np.ascontiguousarray(x)), _data(matrix))
            return matrix.T.copy()

        for held in np.ascontiguousarray(inputs):
            began = time.perf_counter_ns()
            self.library.hold_inputs(_data(held))
            solution = solve_ivp(
                rate, (0.0, step), rows[-1], "Radau", jac=slopes,
                rtol=tolerance, atol=tolerance * self.nominal,
            )  # fmt: skip
            times.append(time.perf_counter_ns() - began)
            rows.append(solution.y[:, -1])
        return Stepped(np.array(times, dtype=float), np.array(rows[1:]))

    def _check(self, failed: int, solver: str) -> None:
        if failed:
            raise SystemExit(f"{self.plant.name}: {solver} failed in sample {failed}")


_REAL = ctypes.c_double


def _data(array: Array) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)
