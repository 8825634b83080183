"""Identification of a Takagi–Sugeno model from data, by the filter and by batch least squares.

`identify` runs over rows (x_k, y_k) exactly what the block `identifier` runs in the
loop, by the block `learner`. `ridge_least_squares` is the batch answer for the consequents, in
which the model is linear:

    min_a Σ_k (y_k − h(x_k, a))²/R_e + (a − a_0)ᵀ·P_0⁻¹·(a − a_0)

to which the filter is equal when it adapts consequents only, with R_v = 0 and no bound met.

This module refuses to know how rows come about; for time series see `narx`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array, Block, StepFunction
from controllers.core.errors import require, require_choice, require_not_negative
from controllers.fuzzy.inference import Membership
from controllers.fuzzy.membership import PARAMETERS
from controllers.fuzzy.takagi_sugeno import SHOULDER, TakagiSugeno
from controllers.identification.adaptation import Adaptation
from controllers.identification.learner import X_P, X_THETA, learner, state

ADAPT = ("all", "consequents", "antecedents")


@dataclass(frozen=True, kw_only=True)
class Uncertainty:
    """P_0 and R_v of antecedents and consequents, what is adapted, and how far sets may move.

    adapt             "all", "consequents" or "antecedents"
    consequent_std, antecedent_std      √P_0 of one component
    consequent_drift, antecedent_drift  √R_v of one component per sample
    centre_play       share of its width that a centre (or end of a plateau) may move; the width
                      is the smaller half-width, β, or 4/|k|
    width_range       factors (low, high) between which half-widths, β and k may change

    With triangles or trapezoids of `takagi_sugeno.partition` and low ≥ (1 + 2·centre_play)/2, as
    by default, neighbours always meet, so some rule always fires.
    """

    adapt: str = "all"
    consequent_std: float = 1.0
    antecedent_std: float = 0.1
    consequent_drift: float = 0.0
    antecedent_drift: float = 0.0
    centre_play: float = 0.25
    width_range: tuple[float, float] = (0.75, 3.0)

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        require_choice("adapt", self.adapt, ADAPT)
        for name in ("consequent_std", "antecedent_std", "consequent_drift", "antecedent_drift"):
            require_not_negative(name, getattr(self, name))
        require_not_negative("centre_play", self.centre_play)
        fits = len(self.width_range) == 2 and 0.0 < self.width_range[0] <= 1.0
        fits = fits and self.width_range[1] >= 1.0
        require(fits, "width_range", "a pair (low, high) with 0 < low <= 1 <= high",
                self.width_range)  # fmt: skip

    def adaptation(
        self, model: TakagiSugeno, r: tuple[float, ...], *, filter: str = "ekf", p: float = 0.05
    ) -> Adaptation:
        """The adaptation of `model` with output variances r (m,), in the units of the model."""
        require(len(r) == len(model.models), "r", f"{len(model.models)} variances", r)
        n = model.n_antecedent
        counts = (n, len(model.theta()) - n)
        on = (float(self.adapt != "consequents"), float(self.adapt != "antecedents"))
        std = (on[0] * self.antecedent_std, on[1] * self.consequent_std)
        drift = (on[0] * self.antecedent_drift, on[1] * self.consequent_drift)
        lower, upper = self.bounds(model)
        variance, noise = np.repeat(np.square(std), counts), np.repeat(np.square(drift), counts)
        fixed = lower == upper
        variance[fixed], noise[fixed] = 0.0, 0.0
        return Adaptation(
            variance=variance, noise=noise, r=r, lower=lower, upper=upper, filter=filter, p=p
        )

    def bounds(self, model: TakagiSugeno) -> tuple[Array, Array]:
        """Bounds (n_θ,) of every component about its value in `model`; none for consequents."""
        pairs = [pair for one in model.inputs for function in one for pair in self._play(function)]
        pairs += [(-np.inf, np.inf)] * (len(model.theta()) - model.n_antecedent)
        lower, upper = np.array(pairs, dtype=np.float64).T
        return lower, upper

    def _play(self, function: Membership) -> list[tuple[float, float]]:
        """Bounds of the parameters of one function; the far end of a shoulder stays."""
        named = dict(zip(PARAMETERS[function.kind], function.parameters, strict=True))
        sizes = {name: q for name, q in named.items() if name[0] in "bk"}
        widths = [4.0 / abs(q) if name == "k" else q for name, q in sizes.items()]
        reach = self.centre_play * min(widths)
        pairs = []
        for name, q in named.items():
            if name in sizes:
                ends = (q * self.width_range[0], q * self.width_range[1])
                pairs.append((min(ends), max(ends)))
            else:
                play = reach if abs(q) < SHOULDER else 0.0
                pairs.append((q - play, q + play))
        return pairs


def interpreted(block: Block) -> StepFunction:
    """The step of a block as it is, in plain Python."""
    return block.step


@dataclass(frozen=True, eq=False)
class Identified:
    """Result of `identify`: the model, P of the adapted components (n_free, n_free), and of each
    row the prediction before it was learnt (k, m), γ (k, m) and νᵀS⁻¹ν (k,)."""

    model: TakagiSugeno
    P: Array
    predicted: Array
    gamma: Array
    normalised_innovation_squared: Array


def identify(
    model: TakagiSugeno, X: Array, Y: Array, adaptation: Adaptation, *, passes: int = 1,
    compile: Callable[[Block], StepFunction] = interpreted,
) -> Identified:  # fmt: skip
    """Adapt `model` to the rows X (k, n), Y (k, m), in order, `passes` times; P is carried over.

    Rows in which no rule fires for an output leave the parameters of that output alone; their
    prediction is the one before. `compile` makes a step function of the block `learner`: with
    `harness.compiler.step.compile_step` the bits are the same, some hundred times as fast.
    """
    X, Y = checked_rows(model, X, Y)
    expected = f"{len(model.theta())} parameters and {Y.shape[1]} outputs, as the model"
    received = (len(adaptation.variance), len(adaptation.r))
    fits = received == (len(model.theta()), Y.shape[1])
    require(fits, "identify: adaptation", expected, received)
    block = learner(model, adaptation)
    step, p, x = compile(block), block.parameters.copy(), block.state.copy()
    rows, told = np.hstack([X, Y]), np.zeros((len(Y), len(block.outputs)))
    for _ in range(passes):
        for row, y in zip(rows, told, strict=True):
            step(p, x, row, y)
    theta, P = state(p, x, X_THETA), state(p, x, X_P)
    n, m = len(adaptation.free), Y.shape[1]
    return Identified(
        model.with_theta(theta), P.reshape(n, n), told[:, :m], told[:, m : 2 * m], told[:, 2 * m]
    )


def ridge_least_squares(
    model: TakagiSugeno, X: Array, Y: Array, r: tuple[float, ...], variance: Array
) -> TakagiSugeno:
    """`model` with the consequents that the module's minimum gives; antecedents as they are.

    `variance` (n_a,) is the diagonal of P_0 of all consequents; np.inf for no ridge. Solved by
    orthogonal factors of the stacked rows, so not by normal equations.
    """
    X, Y = checked_rows(model, X, Y)
    theta, n = model.theta(), model.n_antecedent
    require(np.shape(variance) == (len(theta) - n,), "ridge_least_squares: variance",
            f"shape ({len(theta) - n},)", np.shape(variance))  # fmt: skip
    weight = 1.0 / np.sqrt(np.asarray(r, dtype=np.float64))
    slopes = np.array([model.jacobian(x)[:, n:] for x in X]) * weight[:, None]
    rows = slopes.reshape(-1, len(theta) - n)
    residual = ((Y - model.evaluate(X)) * weight).ravel()
    ridge = np.diag(1.0 / np.sqrt(variance))
    A = np.concatenate([rows, ridge])
    change = np.linalg.lstsq(A, np.concatenate([residual, np.zeros(len(ridge))]), rcond=None)[0]
    theta[n:] += change
    return model.with_theta(theta)


def checked_rows(model: TakagiSugeno, X: Array, Y: Array) -> tuple[Array, Array]:
    """X (k, n) and Y (k, m) as float64 rows; raises `ControllerError` for other shapes."""
    X, Y = (np.ascontiguousarray(rows, dtype=np.float64) for rows in (X, Y))
    n, m = len(model.inputs), len(model.models)
    fits = X.ndim == 2 and Y.ndim == 2 and len(X) == len(Y)
    fits = fits and (X.shape[1], Y.shape[1]) == (n, m)
    require(fits, "rows X, Y", f"shapes (k, {n}) and (k, {m})", (X.shape, Y.shape))
    return X, Y
