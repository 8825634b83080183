"""The step functions of the imperfections: `step(p, x, u, y)`, one reading in, one out.

u[0] is the true value, u[1] (where there is one) the value of the extra source; y[0] is what the
reader gets. Plain Python that numba compiles and that gives the same bits interpreted: no
allocation, no exceptions. NaN passes through.
"""

from __future__ import annotations

import numpy as np

from harness.system.block import Array


def add_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = u + added."""
    y[0] = u[0] + u[1]


def affine_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = p0·u + p1."""
    y[0] = p[0] * u[0] + p[1]


def quantise_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = p0·round(u/p0), halves to the even multiple."""
    y[0] = p[0] * np.rint(u[0] / p[0])


def saturate_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = u within [p0, p1]."""
    if u[0] < p[0]:
        y[0] = p[0]
    elif u[0] > p[1]:
        y[0] = p[1]
    else:
        y[0] = u[0]


def rate_limit_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y follows u by at most p0 up and p1 down a sample; x = (last y, whether there is one)."""
    if x[1] == 0.0:
        y[0] = u[0]
        x[1] = 1.0
    elif u[0] - x[0] > p[0]:
        y[0] = x[0] + p[0]
    elif u[0] - x[0] < -p[1]:
        y[0] = x[0] - p[1]
    else:
        y[0] = u[0]
    x[0] = y[0]


def delay_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y_k = u_{k−n}; x = (place of the oldest reading, the last n readings)."""
    place = int(x[0])
    y[0] = x[1 + place]
    x[1 + place] = u[0]
    place += 1
    if place == x.shape[0] - 1:
        place = 0
    x[0] = float(place)


def pass_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = u."""
    y[0] = u[0]


def dropout_hold_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = u, or the last reading that arrived where added < p0; x = (that one, is there one)."""
    if x[1] == 0.0 or not u[1] < p[0]:
        x[0] = u[0]
        x[1] = 1.0
    y[0] = x[0]


def dropout_zero_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = u, or 0 where added < p0."""
    if u[1] < p[0]:
        y[0] = 0.0
    else:
        y[0] = u[0]


def lag_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y_k = p0·y_{k−1} + p1·u_k + p2·u_{k−1}; x = (y_{k−1}, u_{k−1}, whether there are)."""
    if x[2] == 0.0:
        y[0] = u[0]
        x[2] = 1.0
    else:
        y[0] = p[0] * x[0] + p[1] * u[0] + p[2] * x[1]
    x[0] = y[0]
    x[1] = u[0]


def value_map_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """y = the second of the pair in p whose first is u; u itself where there is none."""
    y[0] = u[0]
    for i in range(0, p.shape[0], 2):
        if u[0] == p[i]:
            y[0] = p[i + 1]
