"""Gain adaptation by the Mahalanobis distance, equations (13)–(16) of Serkies & Szabat 2013.

The Kalman gain is multiplied by a factor g that falls as the innovations ν grow:

    D²(k)  = Σ_a ν_a²·w_a,          w_a = h_a·P⁻¹·h_aᵀ                                (14), (15)
    D̄²(k)  = 1/g(k−1) · mean of D²(k), D²(k−1), …, D²(k−N+1)                         (16)
    g(k)   = fuzzy(D̄²(k))                                                            Fig. 5

h_a is row a of H, so with H = (1, 0, 0, 0) the weight is the first diagonal element of P⁻¹, as the
paper has it; P is the predicted covariance. The distance "innovation" takes νᵀS⁻¹ν instead, whose
mean is the number of measurements where the filter matches the plant, whatever Q and R are.

The plugged-in score is ψ(γ) = g·γ. What becomes of the covariance is a choice:

"consistent" gives it the gain that acts (Joseph's form), P = P⁻ − (2g − g²)·K·H·P⁻: the modified
Riccati equation, which has a bounded solution, and a stable filter, for every 0 < g < 2 where the
plant has no pole outside the unit circle. A smaller g is answered by a K of another shape.
"riccati" leaves P to the gain K, as (10) does, so that g acts outside of the recursion. Of that
gain only g ≥ 1/2 is sure to be stable (the gain margin of the Kalman filter), and the two-mass
drive loses it between 0.3 and 0.5.

The mean is kept by a ring of N readings, and summed anew each time, so that no rounding gathers.
This module refuses to know the model.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from controllers.core.block import Array
from controllers.core.errors import require, require_finite
from controllers.fuzzy.inference import FuzzySystem, Membership, Rule
from controllers.kalman.extended_kalman import cholesky, innovation_covariance
from controllers.kalman.p_point import ALPHA_E, FACTOR, INNER, KIND, SCALED_SCORE

STATE_DISTANCE, INNOVATION_DISTANCE = 0, 1
DISTANCES = {"state": STATE_DISTANCE, "innovation": INNOVATION_DISTANCE}
COVARIANCES = ("consistent", "riccati")

_FAR = 1e300  # the last membership function does not end


def scale_score(q: Array, g: float, consistent: bool) -> None:
    """Make q (N_SCORE,) the score ψ(γ) = g·γ; see the module for `consistent`."""
    q[KIND] = SCALED_SCORE
    q[INNER] = g
    q[FACTOR] = 1.0
    q[ALPHA_E] = 1.0
    if consistent:
        q[FACTOR] = 2.0 * g - g * g
        q[ALPHA_E] = g


def state_distance(n: int, m: int, P: Array, H: Array, innovation: Array, work: Array) -> float:
    """D² of (14) by P⁻¹ = L⁻ᵀL⁻¹, w_a = |L⁻¹·h_aᵀ|²; NaN where P is not positive definite.
    work is of length
    n·n + n."""
    L = work[: n * n]
    solved = work[n * n :]
    for i in range(n * n):
        L[i] = P[i]
    if not cholesky(n, L):
        return math.nan
    squared = 0.0
    for a in range(m):
        weight = 0.0
        for i in range(n):
            total = H[a * n + i]
            for k in range(i):
                total = total - L[i * n + k] * solved[k]
            solved[i] = total / L[i * n + i]
            weight = weight + solved[i] * solved[i]
        squared = squared + weight * innovation[a] * innovation[a]
    return squared


def innovation_distance(
    n: int, m: int, P: Array, H: Array, R: Array, innovation: Array, work: Array
) -> float:
    """νᵀS⁻¹ν of the predicted covariance; NaN where S is not positive definite. work is of length
    n·m + m·m + m."""
    G = work[: n * m]
    S = work[n * m : n * m + m * m]
    solved = work[n * m + m * m :]
    innovation_covariance(n, m, P, H, R, G, S)
    if not cholesky(m, S):
        return math.nan
    squared = 0.0
    for a in range(m):
        total = innovation[a]
        for b in range(a):
            total = total - S[a * m + b] * solved[b]
        solved[a] = total / S[a * m + a]
        squared = squared + solved[a] * solved[a]
    return squared


def distance_work(n: int, m: int) -> int:
    """Length of the work space of both distances."""
    return max(n * n + n, n * m + m * m + m)


def window_mean(ring: Array, count: int, place: int, value: float) -> float:
    """Put `value` at `place` of the ring and return the mean of its `count` readings so far."""
    ring[place] = value
    total = 0.0
    for i in range(count):
        total = total + ring[i]
    return total / count


@dataclass(frozen=True, kw_only=True)
class GainAdaptation:
    """How g follows D̄²: at `distances[i]` it is `gains[i]`, straight between, constant outside.

    distances   ascending tops of the membership functions of D̄² (four in the paper)
    gains       the weights that they carry, in (0, 2)
    window      N readings
    distance    "state" (weight from P⁻¹) or "innovation" (S⁻¹)
    covariance  "consistent" or "riccati"
    """

    distances: tuple[float, ...]
    gains: tuple[float, ...]
    window: int
    distance: str = "state"
    covariance: str = "consistent"

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        name = "GainAdaptation"
        pairs = len(self.distances) == len(self.gains) >= 2
        require(pairs, f"{name}.distances, gains", "as many of each, at least 2", self.gains)
        for value in (*self.distances, *self.gains):
            require_finite(f"{name}.distances, gains", value)
        ascending = all(b > a for a, b in pairwise(self.distances))
        require(ascending, f"{name}.distances", "ascending numbers", self.distances)
        inside = all(0.0 < g < 2.0 for g in self.gains)
        require(inside, f"{name}.gains", "numbers between 0 and 2", self.gains)
        whole = isinstance(self.window, int) and self.window >= 1
        require(whole, f"{name}.window", "a whole number, at least 1", self.window)
        require(self.distance in DISTANCES, f"{name}.distance", f"one of {tuple(DISTANCES)}",
                self.distance)  # fmt: skip
        require(self.covariance in COVARIANCES, f"{name}.covariance", f"one of {COVARIANCES}",
                self.covariance)  # fmt: skip

    def system(self) -> FuzzySystem:
        """The fuzzy system of Fig. 5: one input, one output, a rule a function."""
        d = self.distances
        steps = [b - a for a, b in pairwise(d)]
        functions = [Membership("trapezoidal", (-_FAR, d[0], 1.0, steps[0]))]
        functions += [
            Membership("triangular", (d[i], steps[i - 1], steps[i])) for i in range(1, len(steps))
        ]
        functions.append(Membership("trapezoidal", (d[-1], _FAR, steps[-1], 1.0)))
        rules = tuple(Rule((i,), (i,)) for i in range(len(d)))
        return FuzzySystem((tuple(functions),), (self.gains,), rules)
