"""A pendulum whose sine is measured: the model of the benchmark of extended Kalman filters.

    x_1⁺ = x_1 + T·x_2,  x_2⁺ = x_2 + T·(−a·sin x_1 − b·x_2 + w),  z = sin x_1 + v

Functions of flat arrays (p = (T, a, b)), as `controllers.kalman.estimator` wants them.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from controllers.core.block import Array, Block, Signal
from controllers.kalman.estimator import Estimator, Measurement, Model

MODEL: dict[str, Any] = {
    "T": 0.01, "a": 9.81, "b": 0.2, "q": 0.5, "R": 0.01, "x_0": [0.5, 0.0],
    "P_0": [[0.1, 0.0], [0.0, 1.0]],
}  # fmt: skip


def rate(p: Array, x: Array, u: Array, out: Array) -> None:
    """The state one sample later."""
    out[0] = x[0] + p[0] * x[1]
    out[1] = x[1] + p[0] * (-p[1] * math.sin(x[0]) - p[2] * x[1])


def jacobian(p: Array, x: Array, u: Array, out: Array) -> None:
    """Its derivative by the state, row by row."""
    out[0] = 1.0
    out[1] = p[0]
    out[2] = -p[0] * p[1] * math.cos(x[0])
    out[3] = 1.0 - p[0] * p[2]


def noise(p: Array, x: Array, u: Array, out: Array) -> None:
    """Its derivative by w."""
    out[0] = 0.0
    out[1] = p[0]


def sine(p: Array, x: Array, u: Array, out: Array) -> None:
    """What is measured."""
    out[0] = math.sin(x[0])


def sine_slope(p: Array, x: Array, u: Array, out: Array) -> None:
    """Its derivative by the state."""
    out[0] = math.cos(x[0])
    out[1] = 0.0


def estimator() -> Block:
    """The filter: z in, estimates of angle and speed first among its outputs."""
    m = MODEL
    model = Model(
        states=(Signal("angle"), Signal("speed")), inputs=(), noises=(Signal("w"),),
        parameters=np.array([m["T"], m["a"], m["b"]]), rate=rate, jacobian=jacobian, noise=noise,
    )  # fmt: skip
    sensor = Measurement(
        signals=(Signal("z"),), output=sine, jacobian=sine_slope, R=np.array([[m["R"]]])
    )
    return Estimator(
        model=model, measurement=sensor, q=np.array([m["q"]]), x_0=np.array(m["x_0"]),
        P_0=np.array(m["P_0"]), discretisation="map",
    ).block(m["T"])  # fmt: skip


def measurements(rows: int) -> Array:
    """z of a pendulum that swings, with noise, shape (rows, 1)."""
    rng, p, x = np.random.default_rng(3), np.array([MODEL["T"], MODEL["a"], MODEL["b"]]), [0.8, 0.0]
    z = np.empty((rows, 1))
    for k in range(rows):
        z[k] = math.sin(x[0]) + 0.1 * rng.standard_normal()
        moved = np.zeros(2)
        rate(p, np.array(x), np.zeros(0), moved)
        x = moved.tolist()
    return z
