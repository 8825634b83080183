"""The p-point estimator: least favourable density, score and factor, eqs (18)–(23), (30), (32).

Among all symmetric densities with mass p outside [−γ_p, γ_p], the one with the smallest Fisher
information is a squared cosine inside and exponential outside (20); its score ψ = −f_0'/f_0 is
the min–max robust influence function (Martin & Masreliez 1975). γ_p = −Φ⁻¹(p/2), so that the
standard normal density is one of the family.

With t = 1/(2·s_m), equation (22) reads cos³t = p·(cos t + t·sin t), which has exactly one root
in (0, π/2), for the left side falls there and the right side rises.

No p gives the Gaussian score ψ(γ) = γ. The Fisher information E (32) is below 1 for every p: it
is largest (0.97689) near p = 0.097, tends to 2/π (the median's) as p → 1, and to 0 as p → 0,
for then only the mass far out is prescribed and anything may happen inside.

This module refuses to know a filter: it designs (`PPoint`, `GAUSSIAN`) and evaluates (`score`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array
from controllers.core.errors import require

# A score as the kernels read it: ψ is inner·tan(slope·γ) inside γ_p and ±tail outside.
KIND, GAMMA_P, SLOPE, INNER, TAIL, FACTOR, ALPHA_E = range(7)
N_SCORE = 7
GAUSSIAN_SCORE, P_POINT_SCORE, SCALED_SCORE = 0, 1, 2

_MINIMUM_P = 1e-9  # below it s_m cannot be told from 1/π in double precision


def score(q: Array, gamma: float) -> float:
    """ψ(γ): γ itself for the Gaussian, (30) with sign(γ) for the p-point estimator, a multiple of
    γ for a scaled gain."""
    if int(q[KIND]) == GAUSSIAN_SCORE:
        return gamma
    if int(q[KIND]) == SCALED_SCORE:
        return float(q[INNER] * gamma)
    if gamma > q[GAMMA_P]:
        return float(q[TAIL])
    if gamma < -q[GAMMA_P]:
        return float(-q[TAIL])
    return float(q[INNER] * math.tan(q[SLOPE] * gamma))


def gaussian_score() -> Array:
    """The score ψ(γ) = γ with factor 1, which makes the robust filter the Kalman filter."""
    return np.array([GAUSSIAN_SCORE, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0])


@dataclass(frozen=True)
class PPoint:
    """p-point estimator for mass p outside [−γ_p, γ_p], 0 < p < 1."""

    p: float

    def __post_init__(self) -> None:
        """Raise `ControllerError` unless p is between 1e-9 and 1 − 1e-9."""
        legal = _MINIMUM_P <= self.p <= 1.0 - _MINIMUM_P
        require(legal, "PPoint.p", "a mass between 1e-9 and 1 − 1e-9", self.p)

    @property
    def gamma_p(self) -> float:
        """γ_p of (18)."""
        from scipy.special import ndtri

        return -float(ndtri(0.5 * self.p))

    @property
    def t(self) -> float:
        """1/(2·s_m), the root of (22), by bisection to the last bit, since scipy.optimize takes
        longer to import than many runs last."""
        low, high = 0.0, 0.5 * math.pi
        while low < (t := 0.5 * (low + high)) < high:
            if math.cos(t) ** 3 > self.p * (math.cos(t) + t * math.sin(t)):
                low = t
            else:
                high = t
        return low

    @property
    def s_m(self) -> float:
        """s_m of (22)."""
        return 0.5 / self.t

    @property
    def K(self) -> float:
        """K of (21)."""
        return (1.0 - self.p) / (self.gamma_p * (1.0 + self.s_m * math.sin(1.0 / self.s_m)))

    @property
    def E(self) -> float:
        """E_F0(ψ') of (32), the Fisher information of f_0: in (0, 1)."""
        tangent = math.tan(self.t)
        return (1.0 - self.p * (1.0 + tangent * tangent)) / (self.s_m * self.gamma_p) ** 2

    def density(self, gamma: Array) -> Array:
        """f_0(γ) of (20)."""
        cosine = math.cos(self.t) ** 2
        size = np.abs(np.asarray(gamma, dtype=np.float64))
        inside = self.K * np.cos(np.minimum(size / self.gamma_p, 1.0) * self.t) ** 2
        beyond = np.maximum(size - self.gamma_p, 0.0)
        outside = self.K * cosine * np.exp(-2.0 * self.K / self.p * cosine * beyond)
        return np.asarray(np.where(size <= self.gamma_p, inside, outside))

    def score(self) -> Array:
        """The score as the kernels read it, shape (N_SCORE,)."""
        inner = 1.0 / (self.s_m * self.gamma_p)
        factor = min(self.E, 1.0)
        return np.array(
            [
                P_POINT_SCORE,
                self.gamma_p,
                self.t / self.gamma_p,
                inner,
                inner * math.tan(self.t),
                factor,
                1.0 - math.sqrt(1.0 - factor),
            ]
        )
