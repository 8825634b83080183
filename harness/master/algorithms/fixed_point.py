"""Solving z = g(z) for the signals by which FMUs are coupled, one evaluation of g a call.

Anderson acceleration: from the last evaluations the combination is taken whose residual
f = g(z) - z would vanish if g were affine,

    z_next = g - dG γ,   γ = argmin | W (f - dF γ) |,

where the columns of dF and dG are differences of successive f and g, and W divides each signal by
its size. An affine g of n signals is solved in n + 1 differences whatever its gain, where plain
repetition needs a contraction; one signal alone is the secant method. Nothing is differentiated.

A signal has converged when |f| is at most `tolerance` times the larger of its nominal value and
its present size. That alone is no proof: where the loop is singular, z runs away until any f is
small beside it. In a direction in which g hardly contracts, f shrinks as the error of z does, so f
must also have shrunk: with s the larger of the nominal value and the first sizes of the signal,

    |f| + eps (size - s) <= s max(tolerance, SHRUNK max over signals of |f_first| / s),

where eps (size - s) is what rounding of a z that has grown so large hides of f. Whole numbers and
booleans take no part in the combination: they are repeated until they stay as they are.

It refuses to know what g is: the program evaluates it between two calls.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from harness.system.block import Array, KernelBlock, Port

MAX_DEPTH = 40
SHRUNK = 1e-3
_EPSILON = float(np.finfo(np.float64).eps)
_DEPENDENT = 1e-9  # a difference that the others explain up to this share of it says nothing


def fixed_point_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """One call an evaluation: u = g(z), y = (state, z); z is left where it has converged.

    state: 1 go on with the new z, 0 converged, NaN given up after the last evaluation allowed.
    p = (n, depth, evaluations allowed, tolerance, nominal value of each signal, 0 where it is
    discrete); x = (evaluations so far, max |f_first| / s, then f, g, w, s (n,), dF, dG,
    Q (depth, n), R (depth, depth), γ (depth,)).
    """
    n, depth = int(p[0]), int(p[1])
    count = int(x[0])
    f, g, w, s = x[2 : 2 + n], x[2 + n : 2 + 2 * n], x[2 + 2 * n : 2 + 3 * n], x[2 + 3 * n :]
    base = 2 + 4 * n
    d_f = x[base : base + depth * n].reshape(depth, n)
    d_g = x[base + depth * n : base + 2 * depth * n].reshape(depth, n)
    column = (count - 1) % depth
    if count == 0:
        x[1] = 0.0
        for i in range(n):
            s[i] = max(p[4 + i], abs(u[i]), abs(y[1 + i]))
            if p[4 + i] > 0.0:
                x[1] = max(x[1], abs(u[i] - y[1 + i]) / s[i])
    share = max(p[3], SHRUNK * x[1])
    converged = True
    for i in range(n):
        new_f = u[i] - y[1 + i]
        if p[4 + i] > 0.0:
            size = max(p[4 + i], abs(u[i]), abs(y[1 + i]))
            w[i] = 1.0 / size
            converged = converged and abs(new_f) <= p[3] * size
            converged = converged and abs(new_f) + _EPSILON * (size - s[i]) <= share * s[i]
        else:
            w[i] = 0.0
            converged = converged and round(u[i]) == round(y[1 + i])
        if count > 0:
            d_f[column, i] = new_f - f[i]
            d_g[column, i] = u[i] - g[i]
        f[i] = new_f
        g[i] = u[i]
    x[0] = count + 1.0
    y[0] = 1.0
    if converged or x[0] >= p[2]:
        y[0] = 0.0 if converged else math.nan
        x[0] = 0.0
        return
    known = min(count, depth)
    combine(x[base:], n, depth, known, column, f, w)
    gamma = x[x.shape[0] - depth :]
    for i in range(n):
        value = g[i]
        if p[4 + i] > 0.0:
            for k in range(known):
                value -= d_g[k, i] * gamma[k]
        y[1 + i] = value


def combine(x: Array, n: int, depth: int, known: int, newest: int, f: Array, w: Array) -> None:
    """γ of the first `known` columns of dF, by Gram-Schmidt from the newest column to the oldest.

    x is the work space of the step from dF on. A column that depends on newer ones gets γ = 0.
    """
    d_f = x[: depth * n].reshape(depth, n)
    q = x[2 * depth * n : 3 * depth * n].reshape(depth, n)
    r = x[3 * depth * n : 3 * depth * n + depth * depth].reshape(depth, depth)
    gamma = x[3 * depth * n + depth * depth :]
    for a in range(known):
        column = (newest - a) % depth
        before = 0.0
        for i in range(n):
            q[a, i] = w[i] * d_f[column, i]
            before += q[a, i] * q[a, i]
        for b in range(a):
            r[b, a] = 0.0
        for _ in range(2):  # once more, as rounding leaves a share of the others behind
            for b in range(a):
                share = 0.0
                for i in range(n):
                    share += q[b, i] * q[a, i]
                r[b, a] += share
                for i in range(n):
                    q[a, i] -= share * q[b, i]
        after = 0.0
        for i in range(n):
            after += q[a, i] * q[a, i]
        r[a, a] = math.sqrt(after)
        if r[a, a] <= _DEPENDENT * math.sqrt(before):
            r[a, a] = 0.0
        for i in range(n):
            q[a, i] = q[a, i] / r[a, a] if r[a, a] > 0.0 else 0.0
    for a in range(known - 1, -1, -1):
        value = 0.0
        for i in range(n):
            value += q[a, i] * w[i] * f[i]
        for b in range(a + 1, known):
            value -= r[a, b] * gamma[(newest - b) % depth]
        gamma[(newest - a) % depth] = value / r[a, a] if r[a, a] > 0.0 else 0.0


def first_sizes(x: Array, n: int) -> Array:
    """s of the n signals, of the state of the step."""
    return x[2 + 3 * n : 2 + 4 * n]


def fixed_point_block(
    nominal: Sequence[float], tolerance: float, max_iterations: int
) -> KernelBlock:
    """A solver of one loop; `nominal` (n,) holds the size of each signal, 0 where it is discrete.

    `max_iterations` evaluations of g are allowed.
    """
    n = len(nominal)
    depth = min(n, MAX_DEPTH)
    return KernelBlock(
        tuple(Port(f"g{i}") for i in range(n)),
        (Port("state"), *(Port(f"z{i}") for i in range(n))),
        fixed_point_step,
        np.array([n, depth, max_iterations, tolerance, *nominal], dtype=np.float64),
        np.zeros(2 + 4 * n + 3 * depth * n + depth * depth + depth),
    )
