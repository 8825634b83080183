"""Membership functions behind one interface: value, slope and derivatives to the parameters.

A function is a kind code and its parameters in a flat array q:

    TRIANGULAR   (a, b⁻, b⁺)       eq. (3) of Ahn & Truong 2009: centre and half-widths
    TRAPEZOIDAL  (a⁻, a⁺, b⁻, b⁺)  1 on [a⁻, a⁺], falling to 0 over b⁻ to the left, b⁺ to the right
    GAUSSIAN     (c, β)            exp(−((x − c)/β)²)
    SIGMOIDAL    (c, k)            1/(1 + exp(−k·(x − c)))

Half-widths and β are greater than 0. At a kink the derivative is that of the branch written
first: at the centre of a triangle the left one, at the foot the one inside, as in (45) and (47).

This module refuses to know what a membership function belongs to.
"""

from __future__ import annotations

import math

from controllers.core.block import Array

TRIANGULAR, TRAPEZOIDAL, GAUSSIAN, SIGMOIDAL = 0, 1, 2, 3
KINDS = {"triangular": 0, "trapezoidal": 1, "gaussian": 2, "sigmoidal": 3}
PARAMETERS = {
    "triangular": ("a", "b_minus", "b_plus"),
    "trapezoidal": ("a_minus", "a_plus", "b_minus", "b_plus"),
    "gaussian": ("c", "beta"),
    "sigmoidal": ("c", "k"),
}

# exp(−700) is still a normal number; beyond it math.exp would raise for the other sign.
_EXPONENT = 700.0


def falling(distance: float, half_width: float) -> float:
    """Value of a flank at `distance` ≥ 0 from the top."""
    if distance <= half_width:
        return 1.0 - distance / half_width
    return 0.0


def logistic(z: float) -> float:
    """1/(1 + exp(−z)) without overflow."""
    if z >= 0.0:
        if z > _EXPONENT:
            return 1.0
        return 1.0 / (1.0 + math.exp(-z))
    if z < -_EXPONENT:
        return 0.0
    grown = math.exp(z)
    return grown / (1.0 + grown)


def bell(z: float) -> float:
    """exp(−z²) without a range error."""
    square = z * z
    if square > _EXPONENT:
        return 0.0
    return math.exp(-square)


def membership(kind: int, x: float, q: Array) -> float:
    """Degree of membership of x, in [0, 1]."""
    if kind == TRIANGULAR:
        if x <= q[0]:
            return falling(q[0] - x, q[1])
        return falling(x - q[0], q[2])
    if kind == TRAPEZOIDAL:
        if x <= q[0]:
            return falling(q[0] - x, q[2])
        if x >= q[1]:
            return falling(x - q[1], q[3])
        return 1.0
    if kind == GAUSSIAN:
        return bell((x - q[0]) / q[1])
    return logistic(q[1] * (x - q[0]))


def left_flank(x: float, q: Array, top: int, width: int, dq: Array) -> float:
    """Derivatives of the rising flank below q[top], (45) and (47); returns the slope."""
    distance = q[top] - x
    if distance > q[width]:
        return 0.0
    slope = 1.0 / float(q[width])
    dq[top] = -slope
    dq[width] = distance * slope * slope
    return slope


def right_flank(x: float, q: Array, top: int, width: int, dq: Array) -> float:
    """Derivatives of the falling flank above q[top], (45) and (47); returns the slope."""
    distance = x - q[top]
    if distance > q[width]:
        return 0.0
    slope = 1.0 / float(q[width])
    dq[top] = slope
    dq[width] = distance * slope * slope
    return -slope


def gaussian_gradient(x: float, q: Array, dq: Array) -> float:
    """Derivatives of exp(−((x − c)/β)²); returns the slope."""
    z = float((x - q[0]) / q[1])
    outer = float(2.0 * z / q[1] * bell(z))
    dq[0] = outer
    dq[1] = outer * z
    return -outer


def sigmoidal_gradient(x: float, q: Array, dq: Array) -> float:
    """Derivatives of the sigmoid; returns the slope."""
    value = logistic(q[1] * (x - q[0]))
    outer = value * (1.0 - value)
    dq[0] = -outer * q[1]
    dq[1] = outer * (x - q[0])
    return float(outer * q[1])


def membership_gradient(kind: int, x: float, q: Array, dq: Array) -> float:
    """Derivatives to the parameters into dq, shape as q; returns the derivative to x."""
    if kind == GAUSSIAN:
        return gaussian_gradient(x, q, dq)
    if kind == SIGMOIDAL:
        return sigmoidal_gradient(x, q, dq)
    dq[0] = 0.0
    dq[1] = 0.0
    dq[2] = 0.0
    if kind == TRIANGULAR:
        if x <= q[0]:
            return left_flank(x, q, 0, 1, dq)
        return right_flank(x, q, 0, 2, dq)
    dq[3] = 0.0
    if x <= q[0]:
        return left_flank(x, q, 0, 2, dq)
    if x >= q[1]:
        return right_flank(x, q, 1, 3, dq)
    return 0.0
