"""From one sample instant to the next: state, its Jacobian, and what held noise does to it.

For a model dx/dt = f(x, u, w), with input u and noise w held over the sample, these kernels give

    x⁺ = φ(x, u, w = 0),    F = ∂φ/∂x,    Γ = ∂φ/∂w

by integrating x together with dF/dt = A·F and dΓ/dt = A·Γ + G, where A = ∂f/∂x and G = ∂f/∂w.
The stages of one method serve all three, so F and Γ are the exact derivatives of the numerical
x⁺, to rounding. They stand one after the other in the flat array X of `transition_size(n, n_w)`:
x (n,), F (n·n) and Γ (n·n_w), row-major.

Process noise of variances q is then Q = Γ·diag(q)·Γᵀ. White noise of intensity q_c is, for the
purpose of its covariance, a held one with q = q_c/T.

`integrate` is Euler's method (stages 1) or the classical Runge–Kutta method (stages 4), in equal
substeps; `apply_map` is for models that are maps already: φ in place of f.

The three `model_…` functions are placeholders, to be named by `controllers.core.bind.bind`:

    bind(integrate, model_slope=bind(model_slope, model_rate=…, model_jacobian=…, model_noise=…))
    bind(apply_map, model_rate=…, model_jacobian=…, model_noise=…)

This module refuses to know a filter.
"""

from __future__ import annotations

from controllers.core.block import Array


def model_rate(p: Array, x: Array, u: Array, rate: Array) -> None:
    """Placeholder: f(x, u, 0) or φ(x, u, 0) into `rate` (n,)."""


def model_jacobian(p: Array, x: Array, u: Array, A: Array) -> None:
    """Placeholder: its derivative to x into `A` (n·n), row-major, every element."""


def model_noise(p: Array, x: Array, u: Array, G: Array) -> None:
    """Placeholder: its derivative to w into `G` (n·n_w), row-major, every element."""


def transition_size(n: int, n_w: int) -> int:
    """Length of X for n states and n_w noises."""
    return n + n * n + n * n_w


def transition_work(n: int, n_w: int) -> int:
    """Length of the work space of `integrate` and `apply_map`."""
    return 3 * transition_size(n, n_w) + n * n + n * n_w


def reset_derivatives(n: int, n_w: int, X: Array) -> None:
    """F = I and Γ = 0, as at the start of a sample."""
    for i in range(n, transition_size(n, n_w)):
        X[i] = 0.0
    for i in range(n):
        X[n + i * (n + 1)] = 1.0


def multiply(rows: int, inner: int, columns: int, A: Array, B: Array, out: Array) -> None:
    """out = A·B for A (rows·inner) and B (inner·columns)."""
    for i in range(rows):
        for j in range(columns):
            total = 0.0
            for k in range(inner):
                total = total + A[i * inner + k] * B[k * columns + j]
            out[i * columns + j] = total


def model_slope(
    n: int, n_w: int, p: Array, u: Array, X: Array, D: Array, A: Array, G: Array
) -> None:
    """D = dX/dt; A and G are work space."""
    x = X[:n]
    gamma = n + n * n
    model_rate(p, x, u, D[:n])
    model_jacobian(p, x, u, A)
    model_noise(p, x, u, G)
    multiply(n, n, n, A, X[n:gamma], D[n:gamma])
    multiply(n, n, n_w, A, X[gamma:], D[gamma:])
    for i in range(n * n_w):
        D[gamma + i] = D[gamma + i] + G[i]


def stage_lead(stage: int) -> float:
    """How far ahead, in substeps, stage 1, 2 or 3 of the Runge–Kutta method looks."""
    if stage == 3:
        return 1.0
    return 0.5


def stage_weight(stages: int, stage: int) -> float:
    """Weight of a stage's slope in the step."""
    if stages == 1:
        return 1.0
    if stage == 0 or stage == 3:
        return 1.0 / 6.0
    return 1.0 / 3.0


def integrate(
    n: int, n_w: int, stages: int, substeps: int, T: float, p: Array, u: Array, X: Array,
    work: Array,
) -> None:  # fmt: skip
    """Advance X by T seconds; `stages` is 1 (Euler) or 4 (Runge–Kutta)."""
    N = transition_size(n, n_w)
    D = work[:N]
    start = work[N : 2 * N]
    total = work[2 * N : 3 * N]
    A = work[3 * N : 3 * N + n * n]
    G = work[3 * N + n * n :]
    h = T / substeps
    for _ in range(substeps):
        for i in range(N):
            start[i] = X[i]
            total[i] = 0.0
        for stage in range(stages):
            if stage > 0:
                for i in range(N):
                    X[i] = start[i] + h * stage_lead(stage) * D[i]
            model_slope(n, n_w, p, u, X, D, A, G)
            weight = stage_weight(stages, stage)
            for i in range(N):
                total[i] = total[i] + weight * D[i]
        for i in range(N):
            X[i] = start[i] + h * total[i]


def apply_map(
    n: int, n_w: int, stages: int, substeps: int, T: float, p: Array, u: Array, X: Array,
    work: Array,
) -> None:  # fmt: skip
    """The same for a model that is a map; stages, substeps and T are not used."""
    gamma = n + n * n
    model_jacobian(p, X[:n], u, X[n:gamma])
    model_noise(p, X[:n], u, X[gamma:])
    model_rate(p, X[:n], u, work[:n])
    for i in range(n):
        X[i] = work[i]


def held_noise(n: int, n_w: int, q: Array, extra: Array, X: Array, Q: Array) -> None:
    """Q (n·n) = Γ·diag(q)·Γᵀ + diag(extra)."""
    gamma = n + n * n
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for k in range(n_w):
                total = total + X[gamma + i * n_w + k] * q[k] * X[gamma + j * n_w + k]
            if i == j:
                total = total + extra[i]
            Q[i * n + j] = total
            Q[j * n + i] = total
