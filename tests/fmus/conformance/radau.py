"""The independent integration: scipy's Radau on a plant's equations, inputs held over each step.

Equations come straight from the plant through CasADi's virtual machine; neither our code
generation nor our solver takes part.
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from fmus.linearization import parameter_values, plant_functions
from fmus.plant import Plant

Array = NDArray[np.float64]
RTOL = 1e-10


def held_reference(plant: Plant, inputs: Array, step: float, rtol: float = RTOL) -> Array:
    """States at k·step, shape like `inputs` (rows, n_x); row k of `inputs` holds from k on."""
    f, _ = plant_functions(plant)
    x, u = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs))
    rate = ca.densify(f(x, u, parameter_values(plant)))
    jacobian = ca.densify(ca.jacobian(rate, x))
    n = len(plant.states)
    derivatives = _called(ca.Function("rate", [x, u], [rate]), (n,))
    slopes = _called(ca.Function("slope", [x, u], [jacobian]), (n, n))
    nominal = np.array([state.nominal for state in plant.states])
    rows = [np.array([state.start for state in plant.states])]
    for held in inputs[:-1]:
        solution = solve_ivp(
            lambda _t, z, held=held: derivatives(z, held),
            (0.0, step),
            rows[-1],
            "Radau",
            jac=lambda _t, z, held=held: slopes(z, held),
            rtol=rtol,
            atol=rtol * nominal,
        )
        assert solution.success, solution.message
        rows.append(solution.y[:, -1])
    return np.array(rows)


def _called(function: ca.Function, shape: tuple[int, ...]) -> Callable[[Array, Array], Array]:
    """`function` of two vectors, called through its buffers: a call costs microseconds."""
    buffer, run = function.buffer()
    arguments = [np.zeros(function.size1_in(i)) for i in range(2)]
    flat = np.zeros(int(np.prod(shape)))
    for i, argument in enumerate(arguments):
        buffer.set_arg(i, memoryview(argument))
    buffer.set_res(0, memoryview(flat))
    kept = (buffer, function)  # the buffer's memory goes with them

    def call(x: Array, u: Array, _kept: object = kept) -> Array:
        arguments[0][:], arguments[1][:] = x, u
        run()
        return flat.reshape(shape, order="F").copy()

    return call
