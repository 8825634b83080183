"""Parameters of a model h(x, p) as the state of an extended Kalman filter, eqs (8)–(15).

The parameters are a random walk and the model's output is their measurement (12):

    p_{k+1} = p_k + v,   y_k = h(x_k, p_k) + e,   Φ = I (13),   C = ∂h/∂p (15)
    P⁻ = P + R_v,   p = p + K·(y − h(x, p)),   P = (I − K·C)·P⁻                   (8)–(11)

with the innovation y − h(x, p̂) where (10) prints y − C·p̂, and R_v added once a sample where (8)
and (11) together add it twice. R_ve = 0. The filter is `controllers.kalman.extended_kalman`, plain
or robust.

Only the `free` components of the parameters are filtered; the others are constants, not states
with a variance of 0, so a mask makes the filter cheaper. With R_v = 0 and a model linear in the
free components this is ridge least squares, recursively. R_v is added to a component only up to
its `ceiling`: without excitation its variance would otherwise grow without end. After an update
the components are projected into their bounds (`controllers.kalman.constraints`).

An adaptation is one flat array of constants c, made by `Adaptation.constants`, and P (n_free²,).
This module refuses to know the model: the caller gives innovation and Jacobian.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.core.block import Array
from controllers.core.errors import require, require_choice, require_not_negative, require_positive
from controllers.core.limit import limit
from controllers.kalman.constraints import project
from controllers.kalman.extended_kalman import add_noise, update, update_work
from controllers.kalman.p_point import N_SCORE, PPoint, gaussian_score

# Constants c: sizes, score, R (m·m), then n_free of each: place in p, R_v, ceiling, bounds.
C_FREE, C_MEASURED, C_PARAMETERS = 0, 1, 2
C_SCORE = 3
C_R = C_SCORE + N_SCORE

FILTERS = ("ekf", "robust_ekf")


def adapt_work(n_free: int, m: int) -> int:
    """Length of the work space of `adapt`: [free p | R_v | free H | filter]."""
    return 2 * n_free + m * n_free + update_work(n_free, m)


def adapt(
    c: Array, p: Array, P: Array, innovation: Array, H: Array, gamma: Array, work: Array
) -> float:
    """One filter step of p (n_p,) and P (n_free²,); returns νᵀS⁻¹ν.

    innovation (m,), H = ∂h/∂p (m·n_p,), gamma (m,) receives the normalised innovation.
    """
    n = int(c[C_FREE])
    m = int(c[C_MEASURED])
    n_p = int(c[C_PARAMETERS])
    rows = C_R + m * m
    part = work[:n]
    noise = work[n : 2 * n]
    slope = work[2 * n : 2 * n + m * n]
    for a in range(n):
        i = int(c[rows + a])
        part[a] = p[i]
        for o in range(m):
            slope[o * n + a] = H[o * n_p + i]
        room = c[rows + 2 * n + a] - P[a * n + a]
        noise[a] = limit(room, 0.0, c[rows + n + a])
    add_noise(n, P, noise)
    squared = update(
        n, m, part, P, innovation, slope, c[C_R:rows], c[C_SCORE:C_R], gamma,
        work[2 * n + m * n :],
    )  # fmt: skip
    project(n, part, P, c[rows + 3 * n : rows + 4 * n], c[rows + 4 * n : rows + 5 * n])
    for a in range(n):
        p[int(c[rows + a])] = part[a]
    return squared


@dataclass(frozen=True, kw_only=True, eq=False)
class Adaptation:
    """How n_p parameters are adapted; every array has shape (n_p,) unless stated.

    variance  P_0, its diagonal; components of variance 0 and no noise are not adapted
    noise     R_v per sample, its diagonal
    r         R_e: variance of each measured output (m,)
    lower, upper  bounds; left out, there are none
    ceiling   variance up to which R_v is added; left out, the variance at the start, or no limit
              where that is 0
    filter    "ekf", or "robust_ekf" with the mass p of the p-point score
    """

    variance: Array
    noise: Array
    r: tuple[float, ...]
    lower: Array | None = None
    upper: Array | None = None
    ceiling: Array | None = None
    filter: str = "ekf"
    p: float = 0.05

    def __post_init__(self) -> None:
        """Raise `ControllerError` for shapes that differ and values that cannot be meant."""
        require_choice("Adaptation.filter", self.filter, FILTERS)
        PPoint(self.p)
        for value in self.r:
            require_positive("Adaptation.r", value)
        shape = np.shape(self.variance)
        for name in ("variance", "noise", "lower", "upper", "ceiling"):
            received = np.shape(getattr(self, name))
            absent = getattr(self, name) is None
            expected = f"shape {shape}, as variance"
            require(absent or received == shape, f"Adaptation.{name}", expected, received)
        for name in ("variance", "noise"):
            for value in getattr(self, name).tolist():
                require_not_negative(f"Adaptation.{name}", value)
        require(len(self.free) > 0, "Adaptation.variance", "one above 0", self.variance.tolist())
        lower, upper = self._bounds()
        expected = "bounds with lower not above upper"
        require(bool((lower <= upper).all()), "Adaptation.lower, upper", expected, (lower, upper))

    @property
    def free(self) -> NDArray[np.intp]:
        """Places of the adapted components in the parameters, shape (n_free,)."""
        return np.flatnonzero((self.variance > 0.0) | (self.noise > 0.0))

    def constants(self) -> Array:
        """c of the kernel."""
        free = self.free
        score = PPoint(self.p).score() if self.filter == "robust_ekf" else gaussian_score()
        sizes = [float(len(free)), float(len(self.r)), float(len(self.variance))]
        ceiling = self.ceiling
        if ceiling is None:
            ceiling = np.where(self.variance > 0.0, self.variance, np.inf)
        R = np.diag(np.array(self.r, dtype=np.float64)).ravel()
        tables = (self.noise, ceiling, *self._bounds())
        return np.concatenate([sizes, score, R, free, *(table[free] for table in tables)])

    def covariance(self) -> Array:
        """P_0 of the free components (n_free²,)."""
        return np.diag(self.variance[self.free]).ravel()

    def work(self) -> int:
        """Length of the kernel's work space."""
        return adapt_work(len(self.free), len(self.r))

    def _bounds(self) -> tuple[Array, Array]:
        shape = np.shape(self.variance)
        lower = np.full(shape, -np.inf) if self.lower is None else self.lower
        upper = np.full(shape, np.inf) if self.upper is None else self.upper
        return lower, upper
