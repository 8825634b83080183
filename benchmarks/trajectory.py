"""The step responses on which plants are measured, and their exact solution.

The command is a step forth, a pause, a step back and a pause, held over each macro step; the
hybrid actuator reaches some 2 kN, as in the lead paper. The reference is scipy's Radau with exact
Jacobian, started anew wherever the command jumps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from fmus.packaging.plant.functions import plant_functions
from fmus.plant import Plant

Array = NDArray[np.float64]
STEP = 0.01
_SHAPE = ((0.05, 0.0), (0.25, 1.0), (0.5, 0.0), (0.7, -1.0), (1.0, 0.0))
"""(until, share of the amplitude), seconds."""


@dataclass(frozen=True)
class Trajectory:
    """inputs (N, n_u) held over step k, states (N + 1, n_x) of the exact solution."""

    plant: Plant
    inputs: Array
    exact: Array

    @property
    def names(self) -> tuple[list[str], list[str]]:
        """Names of the inputs and of the states."""
        return [v.name for v in self.plant.inputs], [s.name for s in self.plant.states]

    def error(self, states: Array) -> Array:
        """Largest error of each state, as a share of its range; `states` (N, n_x) after a step."""
        return np.asarray(np.abs(states - self.exact[1:]).max(axis=0) / np.ptp(self.exact, axis=0))


def step_response(plant: Plant, amplitude: float, rtol: float = 1e-10) -> Trajectory:
    """The trajectory of a plant whose first input is its command; all others stay at start."""
    functions = plant_functions(plant)
    nominal = np.array([state.nominal for state in plant.states])
    inputs, pieces, began = [], [functions.x_start[None]], 0
    for until, share in _SHAPE:
        ended = round(until / STEP)
        u = functions.u_start.copy()
        u[0] = amplitude * share
        times = STEP * np.arange(1, ended - began + 1)
        solution = solve_ivp(
            lambda _t, x, u=u: functions.f(x, u),
            (0.0, times[-1]),
            pieces[-1][-1],
            "Radau",
            times,
            rtol=rtol,
            atol=rtol * nominal,
            jac=lambda _t, x, u=u: functions.f_x(x, u),
        )
        inputs += [u] * (ended - began)
        pieces.append(solution.y.T)
        began = ended
    return Trajectory(plant, np.array(inputs), np.concatenate(pieces))
