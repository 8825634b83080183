"""A linear model for the estimator: dx/dt = A·x + B·u + G·w, or the map x⁺ = A·x + B·u + G·w.

With it the extended Kalman filter is the Kalman filter. Numbers of states, inputs and noises are
those of the matrices. This module refuses to know a filter.
"""

from __future__ import annotations

import numpy as np

from controllers.core.block import Array, Signal
from controllers.core.errors import require
from controllers.kalman.estimator import Measurement, Model

# p of the model: numbers of inputs and noises, then A, B, G row-major; p of the measurement: C.
N_U, N_W, AT_A = 0, 1, 2


def linear_rate(p: Array, x: Array, u: Array, rate: Array) -> None:
    """A·x + B·u."""
    n, n_u = len(x), int(p[N_U])
    at_b = AT_A + n * n
    for i in range(n):
        total = 0.0
        for k in range(n):
            total = total + p[AT_A + i * n + k] * x[k]
        for k in range(n_u):
            total = total + p[at_b + i * n_u + k] * u[k]
        rate[i] = total


def linear_jacobian(p: Array, x: Array, u: Array, A: Array) -> None:
    """A."""
    for i in range(len(x) * len(x)):
        A[i] = p[AT_A + i]


def linear_noise(p: Array, x: Array, u: Array, G: Array) -> None:
    """G."""
    n = len(x)
    at_g = AT_A + n * n + n * int(p[N_U])
    for i in range(n * int(p[N_W])):
        G[i] = p[at_g + i]


def linear_output(p: Array, x: Array, u: Array, h: Array) -> None:
    """C·x."""
    for a in range(len(h)):
        total = 0.0
        for k in range(len(x)):
            total = total + p[a * len(x) + k] * x[k]
        h[a] = total


def linear_output_jacobian(p: Array, x: Array, u: Array, H: Array) -> None:
    """C."""
    for i in range(len(p)):
        H[i] = p[i]


def linear_model(
    states: tuple[Signal, ...],
    inputs: tuple[Signal, ...],
    noises: tuple[Signal, ...],
    A: Array,
    B: Array,
    G: Array,
) -> Model:
    """The model for A (n, n), B (n, n_u), G (n, n_w); raises `ControllerError` for other shapes."""
    n, n_u, n_w = len(states), len(inputs), len(noises)
    for name, array, shape in (("A", A, (n, n)), ("B", B, (n, n_u)), ("G", G, (n, n_w))):
        require(
            np.shape(array) == shape, f"linear_model: {name}", f"shape {shape}", np.shape(array)
        )
    parts = ([n_u, n_w], A, B, G)
    return Model(
        states=states,
        inputs=inputs,
        noises=noises,
        parameters=np.concatenate([np.ravel(part).astype(np.float64) for part in parts]),
        rate=linear_rate,
        jacobian=linear_jacobian,
        noise=linear_noise,
    )


def linear_measurement(signals: tuple[Signal, ...], C: Array, R: Array) -> Measurement:
    """z = C·x + v for C (m, n) and the covariance R (m, m) of v."""
    require(np.ndim(C) == 2, "linear_measurement: C", "a matrix", np.shape(C))
    require(len(C) == len(signals), "linear_measurement: C", f"{len(signals)} rows", len(C))
    return Measurement(
        signals=signals,
        output=linear_output,
        jacobian=linear_output_jacobian,
        R=R,
        parameters=np.ravel(C).astype(np.float64),
    )
