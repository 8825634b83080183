"""Bounds on the components of a filtered vector, kept by projection in the metric of P.

The point nearest to x in (z − x)ᵀP⁻¹(z − x) that has z_i = b is

    z = x + P·e_i·(b − x_i)/P_ii

the estimate after a noiseless measurement of component i: the components that are correlated with
i move along, so what the data said of their combination is kept, which plain clipping loses. The
bounds are taken in turn; what a later one pushes out again, and components without variance, are
clipped. P stays as it is: a bound is no measurement.

This module refuses to know what the components mean.
"""

from __future__ import annotations

from controllers.core.block import Array
from controllers.core.limit import limit


def project(n: int, x: Array, P: Array, lower: Array, upper: Array) -> int:
    """x (n,) into [lower, upper], with P (n·n,); returns how many components had left it."""
    moved = 0
    for i in range(n):
        step = limit(x[i], lower[i], upper[i]) - x[i]
        if step != 0.0:
            moved = moved + 1
            if P[i * n + i] > 0.0:
                share = step / P[i * n + i]
                for j in range(n):
                    x[j] = x[j] + P[j * n + i] * share
    for i in range(n):
        x[i] = limit(x[i], lower[i], upper[i])
    return moved
