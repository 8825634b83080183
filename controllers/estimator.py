"""An extended Kalman filter as a block, for any model and any measurement.

At sample instant k, with measurements z_k and the inputs u_{k−1} held since the instant before:

    predict   x⁻ = φ(x, u_{k−1}),  P⁻ = F·P·Fᵀ + Γ·diag(q)·Γᵀ + diag(extra)
    update    ν = z_k − h(x⁻, u_{k−1}),  then x and P by `extended_kalman.update`

At the first instant nothing is predicted: x_0 and P_0 are those before the first measurement.
The input given at k is kept for the interval that begins there, which is the timing of a loop
that applies u_k right after it read z_k. `score` may be that of a robust filter.

Without measurements the block simulates the model open loop: prediction alone.

The model's functions are bound to the step by `controllers.bind`, so that one step serves every
model and compiles. This module refuses to know a model.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from controllers.bind import bind
from controllers.block import Array, Block, Signal
from controllers.errors import require, require_choice, require_positive
from controllers.extended_kalman import predict, update, update_work
from controllers.p_point import N_SCORE, gaussian_score
from controllers.transition import (
    apply_map,
    held_noise,
    integrate,
    model_slope,
    reset_derivatives,
    transition_size,
    transition_work,
)

ModelFunction = Callable[[Array, Array, Array, Array], None]

STAGES = {"runge_kutta": 4, "euler": 1, "map": 0}

# Parameters: sizes and times, then q, extra, R, score and those of the model.
P_N, P_NU, P_NW, P_M, P_STAGES, P_SUBSTEPS, P_T, P_Q = range(8)
# State: whether the block has run, then u, X, P, Q, h, H, ν, γ and work space.
X_STARTED, X_U = 0, 1


def advance(
    n: int, n_w: int, stages: int, substeps: int, T: float, p: Array, u: Array, X: Array,
    work: Array,
) -> None:  # fmt: skip
    """Placeholder: `transition.integrate` or `transition.apply_map`, bound to a model."""


def measurement(p: Array, x: Array, u: Array, h: Array) -> None:
    """Placeholder: h(x, u) into `h` (m,); u is the input in force when z is read."""


def measurement_jacobian(p: Array, x: Array, u: Array, H: Array) -> None:
    """Placeholder: ∂h/∂x into `H` (m·n), row-major, every element."""


def estimator_step(p: Array, x: Array, u: Array, y: Array) -> None:
    """Step of `Estimator`: inputs of the model, then measurements."""
    n, n_u, n_w, m = int(p[P_N]), int(p[P_NU]), int(p[P_NW]), int(p[P_M])
    at_extra = P_Q + n_w
    at_r = at_extra + n
    at_score = at_r + m * m
    model = p[at_score + N_SCORE :]
    at_x = X_U + n_u
    at_p = at_x + transition_size(n, n_w)
    at_h = at_p + 2 * n * n
    at_nu = at_h + m + m * n
    held = x[X_U:at_x]
    X = x[at_x:at_p]
    P = x[at_p : at_p + n * n]
    h = x[at_h : at_h + m]
    H = x[at_h + m : at_nu]
    nu = x[at_nu : at_nu + m]
    gamma = x[at_nu + m : at_nu + 2 * m]
    work = x[at_nu + 2 * m :]
    if x[X_STARTED] > 0.0:
        Q = x[at_p + n * n : at_h]
        reset_derivatives(n, n_w, X)
        advance(n, n_w, int(p[P_STAGES]), int(p[P_SUBSTEPS]), p[P_T], model, held, X, work)
        held_noise(n, n_w, p[P_Q:at_extra], p[at_extra:at_r], X, Q)
        predict(n, P, X[n : n + n * n], Q, work)
    x[X_STARTED] = 1.0
    measurement(model, X[:n], held, h)
    measurement_jacobian(model, X[:n], held, H)
    for a in range(m):
        nu[a] = u[n_u + a] - h[a]
    R = p[at_r:at_score]
    squared = update(n, m, X[:n], P, nu, H, R, p[at_score : at_score + N_SCORE], gamma, work)
    for j in range(n_u):
        held[j] = u[j]
    show_estimate(n, m, X, P, nu, squared, work, y)


def show_estimate(
    n: int, m: int, X: Array, P: Array, nu: Array, squared: float, work: Array, y: Array
) -> None:
    """Estimate, its deviations, innovation and its deviation, νᵀS⁻¹ν and gain, into y."""
    nm = n * m
    K = work[2 * nm : 3 * nm]
    L = work[3 * nm : 3 * nm + m * m]
    for i in range(n):
        y[i] = X[i]
        y[n + i] = max(P[i * n + i], 0.0) ** 0.5
    for a in range(m):
        total = 0.0
        for b in range(a + 1):
            total = total + L[a * m + b] * L[a * m + b]
        y[2 * n + a] = nu[a]
        y[2 * n + m + a] = total**0.5
    y[2 * n + 2 * m] = squared
    for i in range(nm):
        y[2 * n + 2 * m + 1 + i] = K[i]


@dataclass(frozen=True, kw_only=True, eq=False)
class Model:
    """dx/dt = f(x, u, w), or the map x⁺ = φ(x, u, w), as functions of flat arrays.

    states, inputs, noises  names and units, in the order of x (n,), u (n_u,) and w (n_w,)
    parameters              what the functions get as p
    rate, jacobian, noise   f, ∂f/∂x and ∂f/∂w at w = 0, see `controllers.transition`
    """

    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    noises: tuple[Signal, ...]
    parameters: Array
    rate: ModelFunction
    jacobian: ModelFunction
    noise: ModelFunction


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurement:
    """z = h(x, u) + v: `signals` (m), `output` h and `jacobian` ∂h/∂x as functions like those of
    the model and of the same p, and the covariance `R` of v, shape (m, m)."""

    signals: tuple[Signal, ...]
    output: ModelFunction
    jacobian: ModelFunction
    R: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Estimator:
    """The extended Kalman filter of `model` under `measurement`.

    q               variances of the noises, each held over a sample, shape (n_w,)
    extra           variances added to the states at each sample, shape (n,); left out, none
    x_0, P_0        estimate and covariance before the first measurement, shapes (n,), (n, n)
    discretisation  "runge_kutta" or "euler" for a differential model, "map" for a map
    substeps        steps of it in a sample
    score           of the update, see `p_point`
    """

    model: Model
    measurement: Measurement
    q: Array
    x_0: Array
    P_0: Array
    extra: Array | None = None
    discretisation: str = "runge_kutta"
    substeps: int = 1
    score: Array = field(default_factory=gaussian_score)

    def __post_init__(self) -> None:
        """Raise `ControllerError` for shapes and values that cannot be meant."""
        n, n_w, m = self.sizes
        require_choice("Estimator.discretisation", self.discretisation, STAGES)
        whole = isinstance(self.substeps, int) and self.substeps >= 1
        require(whole, "Estimator.substeps", "a whole number from 1 on", self.substeps)
        shapes = {"q": (n_w,), "x_0": (n,), "P_0": (n, n), "score": (N_SCORE,)}
        given = [(f"Estimator.{name}", getattr(self, name), s) for name, s in shapes.items()]
        given.append(("Measurement.R", self.measurement.R, (m, m)))
        if self.extra is not None:
            given.append(("Estimator.extra", self.extra, (n,)))
        for name, array, shape in given:
            require(np.shape(array) == shape, name, f"shape {shape}", np.shape(array))
            require(bool(np.all(np.isfinite(array))), name, "finite numbers", array)
        for name, matrix in (("Estimator.P_0", self.P_0), ("Measurement.R", self.measurement.R)):
            symmetric = np.array_equal(matrix, np.transpose(matrix))
            require(symmetric, name, "a symmetric matrix", matrix)
        for name in ("q", "extra"):
            variances = getattr(self, name)
            legal = variances is None or bool(np.all(np.asarray(variances) >= 0.0))
            require(legal, f"Estimator.{name}", "variances not below 0", variances)

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of states, noises and measurements."""
        return len(self.model.states), len(self.model.noises), len(self.measurement.signals)

    def step(self) -> Callable[[Array, Array, Array, Array], None]:
        """`estimator_step` with the functions of model and measurement."""
        given = {
            "model_rate": self.model.rate,
            "model_jacobian": self.model.jacobian,
            "model_noise": self.model.noise,
        }
        if self.discretisation == "map":
            move = bind(apply_map, **given)
        else:
            move = bind(integrate, model_slope=bind(model_slope, **given))
        return bind(
            estimator_step,
            advance=move,
            measurement=self.measurement.output,
            measurement_jacobian=self.measurement.jacobian,
        )

    def outputs(self) -> tuple[Signal, ...]:
        """Estimates, `std_…`, `innovation_…`, `innovation_std_…`, `nis` and `gain_…_by_…`."""
        states, measured = self.model.states, self.measurement.signals
        starts = zip(states, self.x_0, strict=True)
        return (
            *(Signal(s.name, s.unit, f"estimate: {s.description}", float(v)) for s, v in starts),
            *(
                Signal(f"std_{s.name}", s.unit, "standard deviation of the estimate")
                for s in states
            ),
            *(Signal(f"innovation_{z.name}", z.unit, "measured − predicted") for z in measured),
            *(Signal(f"innovation_std_{z.name}", z.unit, "its deviation, √S") for z in measured),
            Signal("nis", "1", "normalised innovation squared, νᵀS⁻¹ν"),
            *(
                Signal(f"gain_{s.name}_by_{z.name}", _quotient(s.unit, z.unit), "element of K")
                for s in states
                for z in measured
            ),
        )

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        require_positive("Estimator.block: sample_time", sample_time)
        n, n_w, m = self.sizes
        n_u = len(self.model.inputs)
        extra = np.zeros(n) if self.extra is None else self.extra
        head = [n, n_u, n_w, m, STAGES[self.discretisation], self.substeps, sample_time]
        parts = (head, self.q, extra, self.measurement.R, self.score, self.model.parameters)
        X = np.zeros(transition_size(n, n_w))
        X[:n] = self.x_0
        work = max(transition_work(n, n_w), update_work(n, m))
        rest = n * n + m + m * n + 2 * m + work
        return Block(
            inputs=(*self.model.inputs, *self.measurement.signals),
            outputs=self.outputs(),
            step=self.step(),
            parameters=np.concatenate([np.ravel(a).astype(np.float64) for a in parts]),
            state=np.concatenate([np.zeros(1 + n_u), X, np.ravel(self.P_0), np.zeros(rest)]),
        )


def _quotient(above: str, below: str) -> str:
    """Unit string of a quotient."""
    first, second = (f"({unit})" if "/" in unit else unit for unit in (above, below))
    return above if below == "1" else f"{first}/{second}"
