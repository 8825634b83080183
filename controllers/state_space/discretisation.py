"""Sampling a linear model exactly: its state one sample later, the input held in between.

    dx/dt = A·x + B·u,  u held for T:    x(t + T) = Φ·x(t) + Γ·u
    Φ = exp(A·T) = Σ (A·T)^k/k!,   Γ = ∫₀ᵀ exp(A·t) dt·B = Σ A^k·T^(k+1)/(k+1)!·B

The kernel halves T until ‖A·T‖ is at most 1/2, where 12 terms reach rounding, and doubles back by
Φ(2T) = Φ², Γ(2T) = Φ·Γ + Γ. It does not allocate, so a model may be sampled anew in every step.

This module refuses to know whose model it is.
"""

from __future__ import annotations

import numpy as np

from controllers.core.block import Array
from controllers.core.errors import require, require_positive

_TERMS = 12  # 0.5^13/13! is 2e-14
_MOST_HALVINGS = 60


def hold_work(n: int, m: int) -> int:
    """Length of the work space of `hold` for n states and m inputs."""
    return 3 * n * n + n * m


def _norm(n: int, A: Array) -> float:
    """Largest row sum of |A|."""
    largest = 0.0
    for i in range(n):
        total = 0.0
        for j in range(n):
            total = total + abs(A[i * n + j])
        if total > largest:
            largest = total
    return largest


def multiply(rows: int, inner: int, columns: int, X: Array, Y: Array, Z: Array) -> None:
    """Z = X·Y for X (rows·inner,) and Y (inner·columns,), row by row; Z is another array."""
    for i in range(rows):
        for j in range(columns):
            total = 0.0
            for k in range(inner):
                total = total + X[i * inner + k] * Y[k * columns + j]
            Z[i * columns + j] = total


def _series(n: int, A: Array, T: float, Phi: Array, integral: Array, term: Array, next_term: Array,
) -> None:  # fmt: skip
    """Φ and ∫₀ᵀ exp(A·t) dt by their series."""
    for i in range(n * n):
        term[i] = 0.0
    for i in range(n):
        term[i * n + i] = 1.0
    for i in range(n * n):
        Phi[i] = term[i]
        integral[i] = T * term[i]
    for k in range(1, _TERMS + 1):
        multiply(n, n, n, A, term, next_term)
        for i in range(n * n):
            term[i] = next_term[i] * (T / k)
            Phi[i] = Phi[i] + term[i]
            integral[i] = integral[i] + term[i] * (T / (k + 1))


def hold(
    n: int, m: int, A: Array, B: Array, T: float, Phi: Array, Gamma: Array, work: Array
) -> None:
    """Φ (n·n,) and Γ (n·m,) of A (n·n,) and B (n·m,) for the sample time T; NaN where A is not
    finite. `work` is of length `hold_work(n, m)`."""
    integral = work[: n * n]
    term = work[n * n : 2 * n * n]
    other = work[2 * n * n : 3 * n * n]
    moved = work[3 * n * n :]
    size = _norm(n, A) * T
    halvings = 0
    while size > 0.5 and halvings < _MOST_HALVINGS:
        size = 0.5 * size
        halvings = halvings + 1
    _series(n, A, T * 0.5**halvings, Phi, integral, term, other)
    multiply(n, n, m, integral, B, Gamma)
    for _ in range(halvings):
        multiply(n, n, m, Phi, Gamma, moved)
        for i in range(n * m):
            Gamma[i] = Gamma[i] + moved[i]
        multiply(n, n, n, Phi, Phi, other)
        for i in range(n * n):
            Phi[i] = other[i]


def held(A: Array, B: Array, sample_time: float) -> tuple[Array, Array]:
    """Φ (n, n) and Γ (n, m) of A (n, n) and B (n, m), offline.

    Raises `ControllerError` for shapes that do not fit or a sample time that is not positive.
    """
    n, m = len(A), np.shape(B)[-1]
    require(np.shape(A) == (n, n), "held: A", f"shape {(n, n)}", np.shape(A))
    require(np.shape(B) == (n, m), "held: B", f"shape {(n, m)}", np.shape(B))
    require_positive("held: sample_time", sample_time)
    Phi, Gamma, work = np.empty(n * n), np.empty(n * m), np.empty(hold_work(n, m))
    hold(n, m, np.ravel(A).astype(float), np.ravel(B).astype(float), sample_time, Phi, Gamma, work)
    return Phi.reshape(n, n), Gamma.reshape(n, m)
