"""Placing the poles of a single-input loop by state feedback, and the record of the design.

    dx/dt = A·x + b·u,  u = −K·x:    det(s·I − A + b·K) = Π (s − p_i)

Ackermann's formula, K = (0 … 0 1)·C⁻¹·φ(A) with C = (b, A·b, …) and φ the wanted polynomial. It
takes poles of any multiplicity, as the double pairs of equations (5)–(8) of Serkies & Szabat 2013
are. `with_integral` puts the integral of the error of one output before a model.

Design is separate from running: `state_feedback` applies gains.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.core.block import Array
from controllers.core.errors import require

Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class PolePlacement:
    """A design: `K` (n,) of u = −K·x, wanted and reached poles (n,) in 1/s, and the wanted and
    reached characteristic polynomials (n + 1,), highest power first."""

    K: Array
    wanted: Complex
    poles: Complex
    wanted_polynomial: Array
    polynomial: Array

    @property
    def residual(self) -> float:
        """Largest difference of the polynomials' coefficients, relative to the wanted ones of the
        poles' magnitudes (no cancellation hides in it)."""
        scale = np.poly(-np.abs(self.wanted)).real
        return float(np.max(np.abs(self.polynomial - self.wanted_polynomial) / scale))


def characteristic_polynomial(A: Array) -> Array:
    """det(s·I − A), highest power first, by Faddeev and LeVerrier: no eigenvalues are taken."""
    n = len(A)
    coefficients = np.ones(n + 1)
    M = np.eye(n)
    for k in range(1, n + 1):
        AM = A @ M
        coefficients[k] = -np.trace(AM) / k
        M = AM + coefficients[k] * np.eye(n)
    return coefficients


def design_of(A: Array, b: Array, K: Array, poles: Sequence[complex]) -> PolePlacement:
    """The record of gains `K` that were meant to place `poles`, however they were found."""
    closed = np.asarray(A, float) - np.outer(b, K)
    wanted = np.asarray(poles, dtype=np.complex128)
    return PolePlacement(
        K=np.asarray(K, dtype=np.float64),
        wanted=wanted,
        poles=np.linalg.eigvals(closed).astype(np.complex128),
        wanted_polynomial=np.real(np.poly(wanted)).astype(np.float64),
        polynomial=characteristic_polynomial(closed),
    )


def place(A: Array, b: Array, poles: Sequence[complex]) -> PolePlacement:
    """Gains that place `poles` (closed under conjugation) for A (n, n) and b (n,).

    Raises `ControllerError` where shapes do not fit, poles are not real or paired, or (A, b) is
    not controllable.
    """
    A = np.asarray(A, dtype=np.float64)
    b = np.asarray(b, dtype=np.float64).ravel()
    n = len(b)
    require(A.shape == (n, n), "place: A", f"shape {(n, n)}", A.shape)
    require(len(poles) == n, "place: poles", f"{n} poles", poles)
    polynomial = np.poly(np.asarray(poles, dtype=np.complex128))
    paired = bool(np.all(np.abs(np.imag(polynomial)) <= 1e-9 * np.abs(polynomial)))
    require(paired, "place: poles", "real poles and conjugate pairs", poles)
    C = np.column_stack([np.linalg.matrix_power(A, k) @ b for k in range(n)])
    controllable = np.linalg.matrix_rank(C / np.linalg.norm(C, axis=0)) == n
    require(bool(controllable), "place: (A, b)", "a controllable pair", (A.tolist(), b.tolist()))
    phi = np.zeros((n, n))
    for coefficient in np.real(polynomial):
        phi = A @ phi + coefficient * np.eye(n)
    K = np.linalg.solve(C.T, np.eye(n)[-1]) @ phi
    return design_of(A, b, K, poles)


def with_integral(A: Array, b: Array, c: Array) -> tuple[Array, Array]:
    """A and b of the states (∫(0 − c·x) dt, x): the last row of the loop's design comes first.

    With gains (−k_I, k_1, …) of this model the control is u = k_I·∫e dt − k_1·x_1 − …
    """
    n = len(b)
    extended = np.zeros((n + 1, n + 1))
    extended[0, 1:] = -np.asarray(c, float)
    extended[1:, 1:] = A
    return extended, np.concatenate([[0.0], np.ravel(b)])
