"""A plant's equations as numeric functions: for estimators, trimming and linearising.

    dx/dt = f(x, u, p)        y = h(x, u, p)

This module refuses to know FMUs; the same expressions become the FMU in `codegen.py`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from fmus.declaration import PlantModel
from fmus.packaging.errors import PackagingError
from fmus.packaging.plant.expressions import plant_expressions

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinearModel:
    """dx' = A dx + B du, dy = C dx + D du about an operating point (x, u)."""

    A: Array
    B: Array
    C: Array
    D: Array
    x: Array
    u: Array


@dataclass(frozen=True, eq=False)
class PlantFunctions:
    """Numeric f, h and their Jacobians; vectors in the order in which the plant declares.

    Shapes: x (n_x,), u (n_u,), p (n_p,), y (n_y,) with all outputs of the plant. `x_start`,
    `u_start` and `p_start` are the declared defaults; p defaults to `p_start` everywhere.
    """

    plant: PlantModel
    x_start: Array
    u_start: Array
    p_start: Array
    _f: Any
    _h: Any
    _jacobians: Any

    def f(self, x: ArrayLike, u: ArrayLike, p: ArrayLike | None = None) -> Array:
        """Time derivative of the states, (n_x,)."""
        return _vector(self._f(*self._arguments(x, u, p)))

    def h(self, x: ArrayLike, u: ArrayLike, p: ArrayLike | None = None) -> Array:
        """Outputs, (n_y,)."""
        return _vector(self._h(*self._arguments(x, u, p)))

    def jacobians(
        self, x: ArrayLike, u: ArrayLike, p: ArrayLike | None = None
    ) -> tuple[Array, Array, Array, Array]:
        """df/dx (n_x, n_x), df/du (n_x, n_u), dh/dx (n_y, n_x), dh/du (n_y, n_u), exact."""
        f_x, f_u, h_x, h_u = self._jacobians(*self._arguments(x, u, p))
        return _matrix(f_x), _matrix(f_u), _matrix(h_x), _matrix(h_u)

    def f_x(self, x: ArrayLike, u: ArrayLike, p: ArrayLike | None = None) -> Array:
        """df/dx, (n_x, n_x)."""
        return self.jacobians(x, u, p)[0]

    def linearise(self, x: ArrayLike, u: ArrayLike, p: ArrayLike | None = None) -> LinearModel:
        """The plant to first order about (x, u), which need not be an equilibrium."""
        A, B, C, D = self.jacobians(x, u, p)
        return LinearModel(A, B, C, D, np.array(x, dtype=float), np.array(u, dtype=float))

    def trim(
        self,
        u: ArrayLike,
        p: ArrayLike | None = None,
        x_guess: ArrayLike | None = None,
        tolerance: float = 1e-9,
    ) -> Array:
        """States x with f(x, u, p) = 0, from `x_guess` (default `x_start`).

        Solved by least squares in x / nominal, so that a plant with free states (a position that
        nothing holds) stays near the guess. Raises PackagingError when a state would still move
        by more than `tolerance` of its nominal a second.
        """
        nominal = np.array([state.nominal for state in self.plant.states])
        guess = self.x_start if x_guess is None else np.asarray(x_guess, dtype=float)

        def scaled_f(z: Array) -> Array:
            return np.asarray(self.f(z * nominal, u, p) / nominal)

        def scaled_f_x(z: Array) -> Array:
            return np.asarray(self.f_x(z * nominal, u, p) * nominal / nominal[:, None])

        solution = least_squares(
            scaled_f, guess / nominal, scaled_f_x, xtol=1e-15, ftol=1e-15, gtol=1e-15, x_scale="jac"
        )
        worst = int(np.argmax(np.abs(solution.fun)))
        if not abs(solution.fun[worst]) <= tolerance:
            state = self.plant.states[worst]
            rate = f"{solution.fun[worst] * state.nominal:g} {state.unit}"
            raise PackagingError(
                f"Plant {self.plant.name!r}: no equilibrium found for u = {np.asarray(u)}; "
                f"{state.name!r} still moves by {rate} a second. Give another x_guess or input."
            )
        return np.asarray(solution.x * nominal, dtype=float)

    def _arguments(self, x: ArrayLike, u: ArrayLike, p: ArrayLike | None) -> tuple[Any, Any, Any]:
        return (
            self._checked(x, self.x_start, "states"),
            self._checked(u, self.u_start, "inputs"),
            self.p_start if p is None else self._checked(p, self.p_start, "parameters"),
        )

    def _checked(self, values: ArrayLike, template: Array, what: str) -> Array:
        array = np.asarray(values, dtype=float)
        if array.shape != template.shape:
            raise PackagingError(
                f"Plant {self.plant.name!r}: {what} have shape {array.shape}, expected "
                f"{template.shape}."
            )
        return array


def plant_functions(plant: PlantModel) -> PlantFunctions:
    """Numeric functions of a plant; raises PackagingError when its equations are not sound."""
    e = plant_expressions(plant)
    arguments = [e.x, e.u, e.p]
    jacobians = [ca.jacobian(e.dx, e.x), ca.jacobian(e.dx, e.u)]
    jacobians += [ca.jacobian(e.h, e.x), ca.jacobian(e.h, e.u)]
    return PlantFunctions(
        plant,
        np.array([state.start for state in plant.states], dtype=float),
        np.array([variable.start for variable in plant.inputs], dtype=float),
        np.array([parameter.value for parameter in plant.parameters], dtype=float),
        ca.Function("f", arguments, [e.dx], {"cse": True}),
        ca.Function("h", arguments, [e.h], {"cse": True}),
        ca.Function("jacobians", arguments, jacobians, {"cse": True}),
    )


def _vector(value: Any) -> Array:
    return np.asarray(value.full(), dtype=float).reshape(-1)


def _matrix(value: Any) -> Array:
    return np.asarray(value.full(), dtype=float)
