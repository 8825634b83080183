"""One extended Kalman filter, plain or robust, (15)–(17) and (24)–(32) of Ahn & Truong 2009.

Prediction, with the model's Jacobian F:      P⁻ = F·P·Fᵀ + Q                             (15)
Update, with innovation ν and S = H·P⁻·Hᵀ + R = L·Lᵀ (Cholesky), T = L⁻¹, TᵀT = S⁻¹:      (27)

    γ = T·ν,   x = x⁻ + P⁻HᵀTᵀ·ψ(γ)                                                       (29)
    P = (I − E·K·H)·P⁻,   K = P⁻HᵀTᵀT                                                     (31)

ψ(γ) = γ, E = 1 is the Kalman filter; ψ and E of `p_point.PPoint` the robust one. With several
measurements ψ acts on each component of the whitened innovation. (31) is evaluated as

    P = (I − αKH)·P⁻·(I − αKH)ᵀ + α²·K·R·Kᵀ,   α = 1 − √(1 − E),

which equals it exactly (2α − α² = E) and is a sum of squares, so P stays symmetric (to the bit)
and positive semidefinite (to the rounding of P⁻) for every 0 < E ≤ 1; E = 1 is Joseph's form.

The kernels `predict`, `add_noise` and `update` work on flat row-major arrays without allocating
and are what steps call; `predicted` and `updated` are the same for numpy arrays, offline.

This module refuses to know a model: the caller advances x, and gives F, H and the innovation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array
from controllers.core.errors import require
from controllers.kalman.p_point import ALPHA_E, gaussian_score, score


def update_work(n: int, m: int) -> int:
    """Length of the work space of `update` for n states and m measurements."""
    return n * n + 3 * n * m + m * m


def predict(n: int, P: Array, F: Array, Q: Array, work: Array) -> None:
    """P ← F·P·Fᵀ + Q, all (n·n,); work (n·n,)."""
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total = total + F[i * n + k] * P[k * n + j]
            work[i * n + j] = total
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for k in range(n):
                total = total + work[i * n + k] * F[j * n + k]
            total = total + 0.5 * (Q[i * n + j] + Q[j * n + i])
            P[i * n + j] = total
            P[j * n + i] = total


def add_noise(n: int, P: Array, q: Array) -> None:
    """P ← P + diag(q): the prediction of a random walk, (35)."""
    for i in range(n):
        P[i * n + i] = P[i * n + i] + q[i]


def cholesky(m: int, S: Array) -> bool:
    """S (m·m,) ← its lower Cholesky factor; False where S is not positive definite."""
    for i in range(m):
        for j in range(i + 1):
            total = S[i * m + j]
            for k in range(j):
                total = total - S[i * m + k] * S[j * m + k]
            if i == j:
                if not total > 0.0:
                    return False
                S[i * m + i] = math.sqrt(total)
            else:
                S[i * m + j] = total / S[j * m + j]
    return True


def innovation_covariance(n: int, m: int, P: Array, H: Array, R: Array, G: Array, S: Array) -> None:
    """G = P·Hᵀ (n·m,) and S = H·G + R (m·m,)."""
    for i in range(n):
        for a in range(m):
            total = 0.0
            for k in range(n):
                total = total + P[i * n + k] * H[a * n + k]
            G[i * m + a] = total
    for a in range(m):
        for b in range(m):
            total = R[a * m + b]
            for k in range(n):
                total = total + H[a * n + k] * G[k * m + b]
            S[a * m + b] = total


def whitened_gain(n: int, m: int, G: Array, L: Array, W: Array, K: Array) -> None:
    """W = G·L⁻ᵀ, the gain for γ, and K = W·L⁻¹ = G·S⁻¹, the gain for ν."""
    for i in range(n):
        for a in range(m):
            total = G[i * m + a]
            for b in range(a):
                total = total - W[i * m + b] * L[a * m + b]
            W[i * m + a] = total / L[a * m + a]
        for c in range(m):
            a = m - 1 - c
            total = W[i * m + a]
            for b in range(a + 1, m):
                total = total - K[i * m + b] * L[b * m + a]
            K[i * m + a] = total / L[a * m + a]


def shrink_covariance(
    n: int, m: int, P: Array, H: Array, R: Array, alpha: float, G: Array, K: Array, V: Array,
    A: Array,
) -> None:  # fmt: skip
    """P ← (I − αKH)·P·(I − αKH)ᵀ + α²KRKᵀ; A (n·n,) and V (n·m,) are work space."""
    for i in range(n):
        for j in range(n):
            total = P[i * n + j]
            for a in range(m):
                total = total - alpha * K[i * m + a] * G[j * m + a]
            A[i * n + j] = total
    for i in range(n):
        for a in range(m):
            total = 0.0
            for k in range(n):
                total = total + A[i * n + k] * H[a * n + k]
            for b in range(m):
                total = total - alpha * K[i * m + b] * R[b * m + a]
            V[i * m + a] = total
    for i in range(n):
        for j in range(i + 1):
            total = A[i * n + j]
            for a in range(m):
                total = total - alpha * V[i * m + a] * K[j * m + a]
            P[i * n + j] = total
            P[j * n + i] = total


def update(
    n: int, m: int, x: Array, P: Array, innovation: Array, H: Array, R: Array, q: Array,
    gamma: Array, work: Array,
) -> float:  # fmt: skip
    """Update x (n,) and P (n·n,) by the innovation (m,); returns νᵀS⁻¹ν.

    H (m·n,), R (m·m,), q a score of `p_point`, gamma (m,) receives the normalised innovation,
    work is of length `update_work(n, m)`. Where S is not positive definite nothing is updated
    and NaN is returned.
    """
    nm = n * m
    G = work[:nm]
    W = work[nm : 2 * nm]
    K = work[2 * nm : 3 * nm]
    L = work[3 * nm : 3 * nm + m * m]
    A = work[3 * nm + m * m :]
    innovation_covariance(n, m, P, H, R, G, L)
    if not cholesky(m, L):
        return math.nan
    whitened_gain(n, m, G, L, W, K)
    squared = 0.0
    for a in range(m):
        total = innovation[a]
        for b in range(a):
            total = total - L[a * m + b] * gamma[b]
        gamma[a] = total / L[a * m + a]
        squared = squared + gamma[a] * gamma[a]
    for i in range(n):
        total = x[i]
        for a in range(m):
            total = total + W[i * m + a] * score(q, gamma[a])
        x[i] = total
    shrink_covariance(n, m, P, H, R, q[ALPHA_E], G, K, W, A)
    return squared


@dataclass(frozen=True, eq=False)
class Update:
    """Result of `updated`: mean x (n,), covariance P (n, n), γ (m,) and ν'S⁻¹ν."""

    x: Array
    P: Array
    gamma: Array
    normalised_innovation_squared: float


def predicted(P: Array, F: Array, Q: Array) -> Array:
    """F·P·Fᵀ + Q for (n, n) arrays."""
    n = len(P)
    flat = np.array(P, dtype=np.float64).ravel()
    predict(n, flat, np.ravel(F).astype(float), np.ravel(Q).astype(float), np.empty(n * n))
    return flat.reshape(n, n)


def updated(
    x: Array, P: Array, innovation: Array, H: Array, R: Array, q: Array | None = None
) -> Update:
    """The update for x (n,), P (n, n), innovation (m,), H (m, n), R (m, m) and a score q."""
    n, m = len(x), len(innovation)
    for name, array, shape in (("P", P, (n, n)), ("H", H, (m, n)), ("R", R, (m, m))):
        require(np.shape(array) == shape, f"updated: {name}", f"shape {shape}", np.shape(array))
    mean, covariance = np.array(x, dtype=np.float64), np.array(P, dtype=np.float64).ravel()
    nu, H_flat, R_flat = (np.ravel(a).astype(np.float64) for a in (innovation, H, R))
    q = gaussian_score() if q is None else q
    gamma, work = np.zeros(m), np.empty(update_work(n, m))
    squared = update(n, m, mean, covariance, nu, H_flat, R_flat, q, gamma, work)
    return Update(mean, covariance.reshape(n, n), gamma, squared)
