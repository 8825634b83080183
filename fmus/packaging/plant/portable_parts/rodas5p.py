"""Rodas5P in plain Python: the operations of `c/rodas5p.c` in the same order.

So a portable FMU follows the native one bit by bit where both use the same mathematical library.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite
from sys import float_info

from .model import Model, Vector

GAMMA = 0.21193756319429014
_A6 = (
    -7.502846399306121,
    2.561846144803919,
    -11.627539656261098,
    -0.18268767659942256,
    0.030198172008377946,
)
A = (
    (),
    (3.0,),
    (2.849394379747939, 0.45842242204463923),
    (-6.954028509809101, 2.489845061869568, -10.358996098473584),
    (2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641),
    _A6,
    (*_A6, 1.0),
    (*_A6, 1.0, 1.0),
)
C = (
    (),
    (-14.155112264123755,),
    (-17.97296035885952, -2.859693295451294),
    (147.12150275711716, -1.41221402718213, 71.68940251302358),
    (165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306),
    (
        24.854864614690072,
        -3.0009227002832186,
        47.4931110020768,
        5.5814197821558125,
        -0.6610691825249471,
    ),
    (
        30.91273214028599,
        -3.1208243349937974,
        77.79954646070892,
        34.28646028294783,
        -19.097331116725623,
        -28.087943162872662,
    ),
    (
        37.80277123390563,
        -3.2571969029072276,
        112.26918849496327,
        66.9347231244047,
        -40.06618937091002,
        -54.66780262877968,
        -9.48861652309627,
    ),
)
SMALLEST_PIVOT = 1e-6
SHARE = 0.25
MAX_SUBSTEPS = 100_000


class IntegrationError(Exception):
    """A step could not be completed; the message says where and why."""


@dataclass(frozen=True)
class Problem:
    """dx/dt = f(x, u, p) with the inputs and parameters of one step."""

    model: Model
    u: Vector
    p: Vector
    invariants: Vector
    relative_tolerance: float

    def linearise(self, x: Vector) -> tuple[Vector, Vector]:
        """f and the nonzeros of df/dx."""
        return self.model.linearise(x, self.u, self.p, self.invariants)

    def derivatives(self, x: Vector) -> Vector:
        """f."""
        return self.model.derivatives(x, self.u, self.p, self.invariants)


def integrate(problem: Problem, duration: float, x: Vector, substep: float) -> tuple[Vector, float]:
    """State after `duration`, and the substep to try next; raises IntegrationError."""
    smallest = 4.0 * float_info.epsilon * duration
    t, h, attempts, rejected = 0.0, substep, 0, False
    dx, jacobian = x, x
    while t < duration:
        if not rejected:
            dx, jacobian = problem.linearise(x)
            _check_finite(problem.model, dx, jacobian, t)
        if attempts >= MAX_SUBSTEPS:
            raise IntegrationError(f"after {t:g} s of the step: the limit of substeps is reached")
        attempts += 1
        if not h > 0.0:
            h = _first_substep(problem.model, dx, x, duration)
        taken = _fit_substep(h, duration - t)
        candidate, error, worst = _attempt(problem, dx, jacobian, x, taken)
        growth = min(6.0, max(0.2, 0.8 * max(error, 1e-10) ** -0.2))
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
                    f"substep (state '{problem.model.state_names[worst]}')"
                )
    return x, h


def _check_finite(model: Model, dx: Vector, jacobian: Vector, t: float) -> None:
    rows = (*range(len(dx)), *model.state_jacobian_rows)
    for row, value in zip(rows, (*dx, *jacobian), strict=True):
        if not isfinite(value):
            raise IntegrationError(
                f"after {t:g} s of the step: the equations yield NaN or infinity "
                f"(state '{model.state_names[row]}')"
            )


def _first_substep(model: Model, dx: Vector, x: Vector, duration: float) -> float:
    speed = 0.0
    for rate, value, nominal in zip(dx, x, model.x_nominal, strict=True):
        speed = max(speed, abs(rate) / (nominal + abs(value)))
    return 0.01 / speed if speed * duration > 0.01 else duration


def _fit_substep(h: float, remaining: float) -> float:
    if h >= remaining:
        return remaining
    return 0.5 * remaining if 2.0 * h > remaining else h


def _attempt(
    problem: Problem, dx: Vector, jacobian: Vector, x: Vector, h: float
) -> tuple[Vector, float, int]:
    """New state, error norm (infinity for failure) and the worst state of one substep."""
    model, rate = problem.model, 1.0 / h
    factors = _factorise(model, jacobian, h)
    if factors is None:
        return x, inf, 0
    stages: list[Vector] = []
    argument = x
    for s in range(len(A)):
        argument = [_sum(value, A[s], stages, i) for i, value in enumerate(x)]
        right = dx if s == 0 else problem.derivatives(argument)
        right = [r + _sum(0.0, C[s], stages, i) * rate for i, r in enumerate(right)]
        stages.append(model.solve(factors, right))
    candidate = [value + last for value, last in zip(argument, stages[-1], strict=True)]
    return candidate, *_error_norm(problem, x, candidate, stages[-1])


def _sum(start: float, weights: tuple[float, ...], stages: list[Vector], i: int) -> float:
    for weight, stage in zip(weights, stages, strict=True):
        start += weight * stage[i]
    return start


def _factorise(model: Model, jacobian: Vector, h: float) -> Vector | None:
    """Factors of I/(h GAMMA) - J; None when a pivot is all but lost, or not finite."""
    diagonal = 1.0 / (h * GAMMA)
    factors = model.factorise(jacobian, [diagonal])
    inverses = factors[: len(model.x_nominal)]
    return factors if all(abs(v) * diagonal * SMALLEST_PIVOT <= 1.0 for v in inverses) else None


def _error_norm(problem: Problem, x: Vector, candidate: Vector, error: Vector) -> tuple[float, int]:
    """Largest error over its tolerance (infinity for NaN), and its state."""
    largest, worst = -1.0, 0
    for i, nominal in enumerate(problem.model.x_nominal):
        size = max(abs(x[i]), abs(candidate[i]))
        part = abs(error[i]) / (SHARE * problem.relative_tolerance * (nominal + size))
        if not (isfinite(part) and isfinite(candidate[i])):
            return inf, i
        if part > largest:
            largest, worst = part, i
    return largest, worst
