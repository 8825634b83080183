"""An extended Kalman filter as a block, for any model and any measurement.

At sample instant k, with measurements z_k and the inputs u_{k−1} held since the instant before:

    predict   x⁻ = φ(x, u_{k−1}),  P⁻ = F·P·Fᵀ + Γ·diag(q)·Γᵀ + diag(extra)
    update    ν = z_k − h(x⁻, u_{k−1}),  then x and P by `extended_kalman.update`

At the first instant nothing is predicted: x_0 and P_0 are those before the first measurement.
The input given at k is kept for the interval that begins there, which is the timing of a loop
that applies u_k right after it read z_k. Where the control is computed of the estimate itself,
u_k does not exist yet: then the input given at k is u_{k−1} (a wire delayed by one sample), and
`input_interval` is "past". `score` may be that of a robust filter.

Without measurements the block simulates the model open loop: prediction alone.

The model's functions are bound to the step by `controllers.core.bind`, so that one step serves
every model and compiles. `adaptive_kalman` is the block for a model of one sample whose parameters,
noise and gain are scheduled. This module refuses to know a model.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from controllers.core.bind import bind
from controllers.core.block import Array, Block, Signal
from controllers.core.errors import require, require_choice, require_positive
from controllers.kalman.estimator_step import HEAD, MATRICES, STATE, estimator_step
from controllers.kalman.extended_kalman import update_work
from controllers.kalman.p_point import N_SCORE, gaussian_score
from controllers.kalman.transition import (
    apply_map,
    integrate,
    model_slope,
    transition_size,
    transition_work,
)

ModelFunction = Callable[[Array, Array, Array, Array], None]

STAGES = {"runge_kutta": 4, "euler": 1, "map": 0}
INPUT_INTERVALS = {"next": 0.0, "past": 1.0}


@dataclass(frozen=True, kw_only=True, eq=False)
class Model:
    """dx/dt = f(x, u, w), or the map x⁺ = φ(x, u, w), as functions of flat arrays.

    states, inputs, noises  names and units, in the order of x (n,), u (n_u,) and w (n_w,)
    parameters              what the functions get as p
    rate, jacobian, noise   f, ∂f/∂x and ∂f/∂w at w = 0, see `transition`
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
    the model, with `parameters` of their own as p, and the covariance `R` of v, shape (m, m)."""

    signals: tuple[Signal, ...]
    output: ModelFunction
    jacobian: ModelFunction
    R: Array
    parameters: Array = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, kw_only=True, eq=False)
class Estimator:
    """The extended Kalman filter of `model` under `measurement`.

    q               variances of the noises, each held over a sample, shape (n_w,)
    extra           variances added to the states at each sample, shape (n,); left out, none
    x_0, P_0        estimate and covariance before the first measurement, shapes (n,), (n, n)
    discretisation  "runge_kutta" or "euler" for a differential model, "map" for a map
    substeps        steps of it in a sample
    score           of the update, see `p_point`
    input_interval  "next": the input given at k holds from k on; "past": it held until k
    given_start     the first estimate comes through inputs `initial_…`, not from x_0
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
    input_interval: str = "next"
    given_start: bool = False

    def __post_init__(self) -> None:
        """Raise `ControllerError` for shapes and values that cannot be meant."""
        n, n_w, m = self.sizes
        require_choice("Estimator.discretisation", self.discretisation, STAGES)
        require_choice("Estimator.input_interval", self.input_interval, INPUT_INTERVALS)
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

    def start_inputs(self) -> tuple[Signal, ...]:
        """The inputs `initial_…`, read at the first instant only, where the start is given."""
        states = self.model.states if self.given_start else ()
        text = "estimate before the first measurement"
        return tuple(Signal(f"initial_{s.name}", s.unit, text) for s in states)

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        require_positive("Estimator.block: sample_time", sample_time)
        n, n_w, m = self.sizes
        n_u = len(self.model.inputs)
        model, sensor = self.model.parameters, self.measurement.parameters
        sizes = {"inputs": n_u, "states": n, "noises": n_w, "measured": m, "model": len(model)}
        sizes |= {"sensor": len(sensor), "transition": transition_size(n, n_w)}
        sizes["work"] = max(transition_work(n, n_w), update_work(n, m))
        head: dict[str, ArrayLike] = {
            "n": n, "n_u": n_u, "n_w": n_w, "m": m, "stages": STAGES[self.discretisation],
            "substeps": self.substeps, "T": sample_time,
            "past_input": INPUT_INTERVALS[self.input_interval], "given_start": self.given_start,
            "in_parameters": MATRICES.table(HEAD.length, **sizes),
            "in_state": STATE.table(**sizes),
        }  # fmt: skip
        matrices = {
            "q": self.q, "extra": np.zeros(n) if self.extra is None else self.extra,
            "R": self.measurement.R, "score": self.score, "model": model, "sensor": sensor,
        }  # fmt: skip
        X = np.zeros(transition_size(n, n_w))
        X[:n] = self.x_0
        return Block(
            inputs=(*self.model.inputs, *self.measurement.signals, *self.start_inputs()),
            outputs=self.outputs(),
            step=self.step(),
            parameters=np.concatenate([HEAD.fill(head), MATRICES.fill(matrices, **sizes)]),
            state=STATE.fill({"X": X, "P": self.P_0}, **sizes),
        )


def _quotient(above: str, below: str) -> str:
    """Unit string of a quotient."""
    first, second = (f"({unit})" if "/" in unit else unit for unit in (above, below))
    return above if below == "1" else f"{first}/{second}"
