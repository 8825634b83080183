"""RODAS4 in plain Python: the operations of `c/rodas4.c` in the same order.

So a portable FMU follows the native one bit by bit where both use the same mathematical library.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isfinite, sqrt
from sys import float_info

Vector = list[float]

GAMMA = 0.25
A = (
    (),
    (1.544,),
    (0.9466785280815826, 0.2557011698983284),
    (3.314825187068521, 2.896124015972201, 0.9986419139977817),
    (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950),
    (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0),
)
C = (
    (),
    (-5.6688,),
    (-2.430093356833875, -0.2063599157091915),
    (-0.1073529058151375, -9.594562251023355, -20.47028614809616),
    (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160),
    (
        8.083246795921522,
        -7.981132988064893,
        -31.52159432874371,
        16.31930543123136,
        -6.058818238834054,
    ),
)
MAX_SUBSTEPS = 100_000


class IntegrationError(Exception):
    """A step could not be completed; the message says where and why."""


@dataclass(frozen=True)
class Problem:
    """dx/dt = f(x): `linearise` returns f and its Jacobian, row by row in one list."""

    derivatives: Callable[[Vector], Vector]
    linearise: Callable[[Vector], tuple[Vector, Vector]]
    relative_tolerance: float
    scale: tuple[float, ...]
    state_names: tuple[str, ...]


def integrate(problem: Problem, duration: float, x: Vector, substep: float) -> tuple[Vector, float]:
    """State after `duration`, and the substep to try next; raises IntegrationError."""
    smallest = 4.0 * float_info.epsilon * duration
    t, h, attempts, rejected = 0.0, substep, 0, False
    dx, jacobian = x, x
    while t < duration:
        if not rejected:
            dx, jacobian = problem.linearise(x)
            _check_finite(problem, dx, jacobian, t)
        if attempts >= MAX_SUBSTEPS:
            raise IntegrationError(f"after {t:g} s of the step: the limit of substeps is reached")
        attempts += 1
        if not h > 0.0:
            h = _first_substep(problem, dx, x, duration)
        taken = _fit_substep(h, duration - t)
        candidate, error, worst = _attempt(problem, dx, jacobian, x, taken)
        growth = min(6.0, max(0.2, 0.9 / sqrt(sqrt(max(error, 1e-10)))))
        if error <= 1.0:
            x = candidate
            t = t + taken if taken < duration - t else duration
            following = taken * (min(growth, 1.0) if rejected else growth)
            h = max(h, following) if taken < h else following
            rejected = False
        else:
            h = taken * min(growth, 0.9)
            rejected = True
            if h < smallest:
                raise IntegrationError(
                    f"after {t:g} s of the step: the error test fails down to the smallest "
                    f"substep (state '{problem.state_names[worst]}')"
                )
    return x, h


def _check_finite(problem: Problem, dx: Vector, jacobian: Vector, t: float) -> None:
    n = len(dx)
    for k, value in enumerate((*dx, *jacobian)):
        if not isfinite(value):
            name = problem.state_names[k if k < n else (k - n) // n]
            raise IntegrationError(
                f"after {t:g} s of the step: the equations yield NaN or infinity (state '{name}')"
            )


def _first_substep(problem: Problem, dx: Vector, x: Vector, duration: float) -> float:
    speed = 0.0
    for rate, value, scale in zip(dx, x, problem.scale, strict=True):
        speed = max(speed, abs(rate) / (scale + abs(value)))
    return 0.01 / speed if speed * duration > 0.01 else duration


def _fit_substep(h: float, remaining: float) -> float:
    if h >= remaining:
        return remaining
    return 0.5 * remaining if 2.0 * h > remaining else h


def _attempt(
    problem: Problem, dx: Vector, jacobian: Vector, x: Vector, h: float
) -> tuple[Vector, float, int]:
    """New state, error norm (infinity for failure) and the worst state of one substep."""
    factors = _factorise(problem, jacobian, h)
    if factors is None:
        return x, inf, 0
    lu, pivots = factors
    stages: list[Vector] = []
    argument = x
    for s in range(len(A)):
        argument = [_sum(value, A[s], stages, i) for i, value in enumerate(x)]
        right = dx if s == 0 else problem.derivatives(argument)
        stage = [r + _sum(0.0, C[s], stages, i) / h for i, r in enumerate(right)]
        _solve(lu, pivots, stage)
        stages.append(stage)
    candidate = [value + last for value, last in zip(argument, stages[-1], strict=True)]
    return candidate, *_error_norm(problem, x, candidate, stages[-1])


def _sum(start: float, weights: tuple[float, ...], stages: list[Vector], i: int) -> float:
    for weight, stage in zip(weights, stages, strict=True):
        start += weight * stage[i]
    return start


def _error_norm(problem: Problem, x: Vector, candidate: Vector, error: Vector) -> tuple[float, int]:
    total, largest, worst = 0.0, -1.0, 0
    for i, scale in enumerate(problem.scale):
        size = max(abs(x[i]), abs(candidate[i]))
        part = error[i] / (problem.relative_tolerance * (scale + size))
        if not (isfinite(part) and isfinite(candidate[i])):
            return inf, i
        if part * part > largest:
            largest, worst = part * part, i
        total += part * part
    return sqrt(total / len(x)), worst


def _factorise(
    problem: Problem, jacobian: Vector, h: float
) -> tuple[list[Vector], list[int]] | None:
    """LU factors of I/(h GAMMA) - J with the inverses of the pivots, rows weighed by 1/scale; None
    when singular."""
    n = len(problem.scale)
    lu = [[-value for value in jacobian[i * n : (i + 1) * n]] for i in range(n)]
    for i in range(n):
        lu[i][i] += 1.0 / (h * GAMMA)
    weights = [1.0 / scale for scale in problem.scale]
    pivots = []
    for k in range(n):
        pivot, largest = k, 0.0
        for i in range(k, n):
            size = abs(lu[i][k]) * weights[i]
            if size > largest:
                pivot, largest = i, size
        if not (largest > 0.0 and isfinite(largest)):
            return None
        pivots.append(pivot)
        lu[k], lu[pivot] = lu[pivot], lu[k]
        weights[k], weights[pivot] = weights[pivot], weights[k]
        head = lu[k]
        head[k] = 1.0 / head[k]
        for row in lu[k + 1 :]:
            row[k] *= head[k]
            for j in range(k + 1, n):
                if head[j] != 0.0:
                    row[j] -= head[j] * row[k]
    return lu, pivots


def _solve(lu: list[Vector], pivots: list[int], b: Vector) -> None:
    for k, pivot in enumerate(pivots):
        b[k], b[pivot] = b[pivot], b[k]
    n = len(b)
    for k in range(n):
        for i in range(k + 1, n):
            b[i] -= b[k] * lu[i][k]
    for k in range(n - 1, -1, -1):
        b[k] *= lu[k][k]
        for i in range(k):
            b[i] -= b[k] * lu[i][k]
