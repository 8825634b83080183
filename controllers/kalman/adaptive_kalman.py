"""A Kalman filter as a block: any model by its functions, scheduled, with an adapted gain.

At sample instant k, with measurement z_k, known inputs u_k and scheduled parameters s_k:

    u     = a·u_k + (1 − a)·u_{k−1}                  what acted since k − 1
    x⁻, F = transition(s_k, x, u),  P⁻ = F·P·Fᵀ + q·Q
    ẑ, H  = measurement(s_k, x⁻),   ν  = z_k − ẑ
    x     = x⁻ + g·K·ν,             K  = P⁻Hᵀ(H·P⁻·Hᵀ + r·R)⁻¹             (10) of the paper below

g is 1, or adapted by `gain_adaptation`; q and r are 1, or inputs `q_scale`, `r_scale`.
The kernels are those of `extended_kalman`: with a nonlinear transition this is the
extended filter. Q and R are those of one sample. The share a is 0 for a command that the plant
obeys at once and 1 for a reading of what acted; a command that arrives late lies between.

`kalman_block` makes the block of any model; `controllers.papers.serkies2013` has an example.

Why a block beside `estimator`, which has the same kernels: that one integrates a model
in continuous time, and derives Φ and the noise of a sample from it. Here the designer gives Q and
the model of a sample, whose parameters change from one to the next, and what adaptation acts on
lies between the kernels. A filter of both kinds would be the sum of the two.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from controllers.core.bind import bind
from controllers.core.block import Array, Block, Signal, StepFunction
from controllers.core.errors import require
from controllers.kalman import adaptive_kalman_step as kernel
from controllers.kalman.extended_kalman import update_work
from controllers.kalman.gain_adaptation import DISTANCES, GainAdaptation, distance_work
from controllers.kalman.p_point import gaussian_score

Transition = Callable[[Array, Array, Array, Array, Array, Array, Array], None]
Measurement = Callable[[Array, Array, Array, Array, Array], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class KalmanModel:
    """A model as the filter takes it.

    transition(p, s, x, u, following, F, work) and measurement(p, s, x, z, H) are step functions
    (plain Python without allocation); `parameters` is their p, `work` the length of their work
    space; the signals name states, measurements, known inputs and scheduled parameters.
    """

    transition: Transition
    measurement: Measurement
    parameters: Array
    work: int
    states: tuple[Signal, ...]
    measured: tuple[Signal, ...]
    inputs: tuple[Signal, ...] = ()
    scheduled: tuple[Signal, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Noise:
    """Q (n, n), R (m, m) of one sample, P_0 (n, n), x_0 (n,)."""

    Q: Array
    R: Array
    P: Array
    x: Array


def kalman_block(
    model: KalmanModel,
    noise: Noise,
    *,
    adaptation: GainAdaptation | None = None,
    input_share: float = 0.0,
    scaled_noise: bool = False,
) -> Block:
    """The block of a filter; raises `ControllerError` where shapes do not fit.

    `input_share` is a; with `scaled_noise` the block has the inputs q_scale and r_scale.
    """
    n, m = len(model.states), len(model.measured)
    shapes = {"Q": (n, n), "R": (m, m), "P": (n, n), "x": (n,)}
    for name, shape in shapes.items():
        given = np.shape(getattr(noise, name))
        require(given == shape, f"kalman_block: {name}", f"shape {shape}", given)
    inside = 0.0 <= input_share <= 1.0
    require(inside, "kalman_block: input_share", "a share from 0 to 1", input_share)
    scales = (
        Signal("q_scale", "1", "factor of Q", 1.0),
        Signal("r_scale", "1", "factor of R", 1.0),
    )
    p, x = _arrays(model, noise, adaptation, input_share, scaled_noise)
    return Block(
        inputs=(
            *model.measured, *model.inputs, *model.scheduled, *(scales if scaled_noise else ())
        ),
        outputs=_outputs(model),
        step=_step(model.transition, model.measurement),
        parameters=p,
        parameter_names=tuple(f"p_{i}" for i in range(len(p))),
        state=x,
        state_names=tuple(f"x_{i}" for i in range(len(x))),
    )  # fmt: skip


@cache
def _step(transition: Transition, measurement: Measurement) -> StepFunction:
    """The step bound to a model: one function a model, so that it is compiled once."""
    advance = bind(kernel.advance, model_transition=transition)
    expect = bind(kernel.expect, model_measurement=measurement)
    return bind(kernel.adaptive_kalman_step, advance=advance, expect=expect)


def _arrays(
    model: KalmanModel,
    noise: Noise,
    adaptation: GainAdaptation | None,
    input_share: float,
    scaled_noise: bool,
) -> tuple[Array, Array]:
    """p and x in the layout of `adaptive_kalman_step`."""
    n, m, n_u = len(model.states), len(model.measured), len(model.inputs)
    system = None if adaptation is None else adaptation.system()
    structure, theta = (np.zeros(0), np.zeros(0)) if system is None else (
        system.structure(), system.theta()
    )  # fmt: skip
    rules = 0 if system is None else len(system.rules)
    own = n_u + n + 2 * n * n + max(model.work, n * n)
    sizes = {
        "states": n, "measured": m, "inputs": n_u, "model": len(model.parameters),
        "window": 1 if adaptation is None else adaptation.window,
        "structure": len(structure), "theta": len(theta),
        "work": max(own, update_work(n, m), distance_work(n, m), 1 + 3 * rules),
    }  # fmt: skip
    head: dict[str, ArrayLike] = {
        "n": n, "m": m, "n_u": n_u, "n_s": len(model.scheduled), "share": input_share,
        "scaled": scaled_noise, "adapted": adaptation is not None, "window": sizes["window"],
        "distance": 0 if adaptation is None else DISTANCES[adaptation.distance],
        "consistent": adaptation is not None and adaptation.covariance == "consistent",
        "rules": rules,
        "in_parameters": kernel.MATRICES.table(kernel.HEAD.length, **sizes),
        "in_state": kernel.STATE.table(**sizes),
    }  # fmt: skip
    matrices = {
        "model": model.parameters, "Q": noise.Q, "R": noise.R, "structure": structure,
        "theta": theta,
    }  # fmt: skip
    memory = kernel.MEMORY.fill({"gain": 1.0})  # not started, window empty
    state = {"x": noise.x, "P": noise.P, "memory": memory, "score": gaussian_score()}
    p = np.concatenate([kernel.HEAD.fill(head), kernel.MATRICES.fill(matrices, **sizes)])
    return p, kernel.STATE.fill(state, **sizes)


def _outputs(model: KalmanModel) -> tuple[Signal, ...]:
    """Signals in the order of the step's outputs."""
    several = len(model.measured) > 1
    gains = (
        (f"gain_{x.name}" + (f"_{z.name}" if several else ""), x.name, z.name)
        for x in model.states
        for z in model.measured
    )
    return (
        *model.states,
        *(Signal(f"innovation_{z.name}", z.unit, "measured − predicted") for z in model.measured),
        Signal("normalised_innovation_squared", "1", "νᵀS⁻¹ν"),
        Signal("distance", "1", "D̄², mean Mahalanobis distance over the gain"),
        Signal("gain_factor", "1", "g, by which the Kalman gain is multiplied", 1.0),
        *(Signal(name, "", f"gain of {x} for {z} in force") for name, x, z in gains),
        *(Signal(f"variance_{x.name}", "", f"variance of {x.name}") for x in model.states),
    )
