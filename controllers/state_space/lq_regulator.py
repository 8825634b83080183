"""The linear optimal controller: u = −K·x about a rest at x = 0, by `continuous_lq`.

Where Takata et al. call for the ordinary linear optimal controller (LOC), this is it. The control
is computed of the states as they are given at a sample instant, measured or estimated, and held;
it is limited to [u_min, u_max], which are infinite unless given.

Block arrays: p = [n, r, u_min, u_max | K (r·n)], no state.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require
from controllers.core.limit import limit
from controllers.kalman.estimator import Model
from controllers.state_space.affine_model import affine, find_model, require_rest
from controllers.state_space.lq import LQDesign, continuous_lq
from controllers.state_space.state_weights import Weights, weight_matrix

P_N, P_R, P_U_MIN, P_U_MAX, P_K = range(5)


def lq_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `LQRegulator`."""
    n = int(p[P_N])
    for j in range(int(p[P_R])):
        total = 0.0
        for i in range(n):
            total = total - p[P_K + j * n + i] * u[i]
        y[j] = limit(total, p[P_U_MIN], p[P_U_MAX])


def control_signals(model: Model) -> tuple[Signal, ...]:
    """Outputs for the model's inputs: `u`, or `u_1`, `u_2`, … where there are several."""
    several = len(model.inputs) > 1
    return tuple(
        Signal(f"u_{j}" if several else "u", s.unit, f"control: {s.description}")
        for j, s in enumerate(model.inputs, start=1)
    )


@dataclass(frozen=True, kw_only=True)
class LQRegulator:
    """LQ state feedback about x = 0.

    model             a model, or "package.module:Class"; `model_parameters` go to that class
    Q, R              weights of states and inputs: diagonals or matrices
    u_min, u_max      limits of every control

    Its inputs are the states of the model, by their names.
    """

    model: str | Model
    model_parameters: Mapping[str, Any] = field(default_factory=dict)
    Q: Weights
    R: Weights
    u_min: float = -math.inf
    u_max: float = math.inf

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        require(self.u_min < self.u_max, "LQRegulator.u_min, u_max", "u_min below",
                (self.u_min, self.u_max))  # fmt: skip
        _ = self.design  # faults of the weights are found here

    @cached_property
    def design(self) -> LQDesign:
        """The design on the model about x = 0, u = 0."""
        model = find_model(self.model, self.model_parameters)
        require_rest(model)
        n, r = len(model.states), len(model.inputs)
        about = affine(model, [0.0] * n)
        Q = weight_matrix("LQRegulator.Q", self.Q, n)
        R = weight_matrix("LQRegulator.R", self.R, r)
        return continuous_lq(about.A, about.B, Q, R)

    def block(self, sample_time: float) -> Block:
        """The block; the sample time does not enter the gain."""
        model = find_model(self.model, self.model_parameters)
        head = [len(model.states), len(model.inputs), self.u_min, self.u_max]
        return Block(
            inputs=model.states,
            outputs=control_signals(model),
            step=lq_step,
            parameters=np.concatenate([head, self.design.K.ravel()]),
        )
