"""The general Takagi–Sugeno model of Barragán et al., section 2, as data.

Any number of inputs n, outputs m and rules per output. Rule l of output i reads

    if x_1 is A_1 and … and x_n is A_n then y_i = a_0 + a_1·x_1 + … + a_n·x_n

Its sets are membership functions of any kind of `membership`, its own (the paper's
form, `scattered`) or shared with other rules and outputs (`grid`); an input that it does not
name does not matter to it. With one rule that names none the model is linear.

The arithmetic is in `takagi_sugeno_kernels`; this module refuses to know where x comes from and how
parameters are found (`controllers.identification`).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from controllers.core.block import Array
from controllers.core.errors import require, require_choice
from controllers.fuzzy.inference import FuzzySystem, Membership, Rule
from controllers.fuzzy.membership import KINDS, PARAMETERS
from controllers.fuzzy.takagi_sugeno_kernels import (
    model_jacobian,
    model_outputs,
    model_size,
    model_slopes,
    model_work,
)

Kernel = Callable[[Array, Array, Array, Array, Array, Array], None]

_BETA_PER_DISTANCE = 0.5 / float(np.sqrt(np.log(2.0)))  # neighbouring Gaussians cross at 1/2
_LOGIT = float(np.log(19.0))  # a sigmoid with k·d = ln 19 is at 5 % and 95 % at distance d
SHOULDER = 1e6  # where the plateau of an outer trapezoid ends: beyond every scaled input


@dataclass(frozen=True, eq=False)
class TakagiSugeno:
    """A Takagi–Sugeno model.

    inputs       the membership functions of each input, none for one that no rule names
    models       of each output the local models (a_0, …, a_n)
    rules        antecedents: an index into each input's functions, −1: does not matter;
                 consequents: an index into each output's local models, −1: silent on it
    implication  "product", eq. (4), or "min"
    """

    inputs: tuple[tuple[Membership, ...], ...]
    models: tuple[tuple[tuple[float, ...], ...], ...]
    rules: tuple[Rule, ...]
    implication: str = "product"

    def __post_init__(self) -> None:
        """Raise `ControllerError` where rules, functions and local models do not fit together."""
        self.system()
        expected = f"{len(self.inputs) + 1} coefficients (a_0 and one an input)"
        for i, models in enumerate(self.models, start=1):
            where = f"TakagiSugeno.models of output {i}"
            require(len(models) > 0, where, "at least one local model", models)
            for model in models:
                require(len(model) == len(self.inputs) + 1, where, expected, model)

    def system(self) -> FuzzySystem:
        """The fuzzy system underneath, its weights standing for the local models."""
        weights = tuple((0.0,) * len(models) for models in self.models)
        return FuzzySystem(self.inputs, weights, self.rules, self.implication)

    def structure(self) -> Array:
        """s of the kernels."""
        return self.system().structure()

    @property
    def n_antecedent(self) -> int:
        """Components of σ, the first of θ."""
        return sum(len(f.parameters) for functions in self.inputs for f in functions)

    def theta(self) -> Array:
        """θ = [σ | a], shape (n_θ,)."""
        sigma = [q for functions in self.inputs for f in functions for q in f.parameters]
        local = [a for models in self.models for model in models for a in model]
        return np.array(sigma + local, dtype=np.float64)

    def parameter_names(self) -> tuple[str, ...]:
        """Names of θ: `beta_2_1` is β of function 2 of input 1, `a_0_3_1` is a_0 of local model 3
        of output 1."""
        names = [
            f"{part}_{j}_{i}"
            for i, functions in enumerate(self.inputs, start=1)
            for j, function in enumerate(functions, start=1)
            for part in PARAMETERS[function.kind]
        ]
        names += [
            f"a_{j}_{k}_{i}"
            for i, models in enumerate(self.models, start=1)
            for k in range(1, len(models) + 1)
            for j in range(len(self.inputs) + 1)
        ]
        return tuple(names)

    def with_theta(self, theta: Array) -> TakagiSugeno:
        """The same model with other parameters θ (n_θ,)."""
        values = np.asarray(theta, dtype=np.float64)
        shape = (model_size(self.structure()),)
        require(values.shape == shape, "TakagiSugeno.with_theta", f"shape {shape}", values.shape)
        rest = iter(values.tolist())

        def taken(count: int) -> tuple[float, ...]:
            return tuple(itertools.islice(rest, count))

        inputs = tuple(
            tuple(Membership(f.kind, taken(len(f.parameters))) for f in functions)
            for functions in self.inputs
        )
        models = tuple(tuple(taken(len(self.inputs) + 1) for _ in models) for models in self.models)
        return replace(self, inputs=inputs, models=models)

    def evaluate(self, X: Array) -> Array:
        """h at the rows of X (k, n), shape (k, m); NaN where no rule fires."""
        s, theta, rows = self.structure(), self.theta(), self._rows(X)
        work, out = np.zeros(model_work(s)), np.full((len(rows), len(self.models)), np.nan)
        for x, y in zip(rows, out, strict=True):
            model_outputs(s, theta, x, y, work)
        return out

    def jacobian(self, x: Sequence[float] | Array) -> Array:
        """∂h/∂θ at one point, shape (m, n_θ), eqs (15)–(22)."""
        H = np.zeros((len(self.models), len(self.theta())))
        self._differentiated(model_jacobian, x, H)
        return H

    def slopes(self, x: Sequence[float] | Array) -> Array:
        """∂h/∂x at one point, shape (m, n)."""
        G = np.zeros((len(self.models), len(self.inputs)))
        self._differentiated(model_slopes, x, G)
        return G

    def _differentiated(self, kernel: Kernel, x: Sequence[float] | Array, result: Array) -> None:
        s, theta = self.structure(), self.theta()
        point = self._rows(np.asarray(x, dtype=np.float64)[None, :])[0]
        work, out = np.zeros(model_work(s)), np.zeros(len(self.models))
        model_outputs(s, theta, point, out, work)
        kernel(s, theta, point, out, result.reshape(-1), work)

    def _rows(self, X: Array) -> Array:
        rows = np.ascontiguousarray(X, dtype=np.float64)
        fits = rows.ndim == 2 and rows.shape[1] == len(self.inputs)
        require(fits, "TakagiSugeno: points", f"shape (k, {len(self.inputs)})", rows.shape)
        return rows


def grid(inputs: Sequence[Sequence[Membership]], models: Sequence[Sequence[float]]) -> TakagiSugeno:
    """One rule for every combination of the inputs' functions, which the rules share; each output
    starts everywhere with its one local model of `models`."""
    functions = tuple(tuple(one) for one in inputs)
    choices = [range(len(one)) if one else (-1,) for one in functions]
    combinations = list(itertools.product(*choices))
    rules = tuple(Rule(c, (k,) * len(models)) for k, c in enumerate(combinations))
    local = tuple((tuple(float(a) for a in model),) * len(rules) for model in models)
    return TakagiSugeno(functions, local, rules)


def scattered(
    antecedents: Sequence[Sequence[Sequence[Membership]]],
    models: Sequence[Sequence[Sequence[float]]],
) -> TakagiSugeno:
    """The paper's form, every rule with membership functions of its own.

    `antecedents[i][l]` are those of rule l of output i, one an input, `models[i][l]` its local
    model (a_0, …, a_n); the outputs may have different numbers of rules.
    """
    of_all = [own for rules in antecedents for own in rules]
    require(len(of_all) > 0, "scattered: antecedents", "at least one rule", antecedents)
    n = len(of_all[0])
    for own in of_all:
        require(len(own) == n, "scattered: antecedents", f"{n} functions a rule", len(own))
    rules: list[Rule] = []
    for i, one in enumerate(antecedents):
        for k in range(len(one)):
            spoken = tuple(k if o == i else -1 for o in range(len(antecedents)))
            rules.append(Rule((len(rules),) * n, spoken))
    inputs = tuple(tuple(own[j] for own in of_all) for j in range(n))
    local = tuple(tuple(tuple(float(a) for a in m) for m in one) for one in models)
    return TakagiSugeno(inputs, local, tuple(rules))


def partition(kind: str, count: int) -> tuple[Membership, ...]:
    """`count` functions of one kind, evenly over [−1, 1]; none for a count of 1.

    triangular, trapezoidal  sum to 1 everywhere, the outer ones with shoulders (trapezoids);
                             the plateaus of trapezoids take half the distance
    gaussian                 neighbours cross at 1/2
    sigmoidal                the left half falling, the right half rising
    """
    require_choice("partition: kind", kind, KINDS)
    require(count >= 1, "partition: count", "at least 1", count)
    if count == 1:
        return ()
    if kind == "sigmoidal":
        places = [-1.0 + (2 * j + 1) / count for j in range(count)]
        steep = _LOGIT * count
        signs = [-1.0 if 2 * j < count else 1.0 for j in range(count)]
        return tuple(Membership(kind, (c, g * steep)) for c, g in zip(places, signs, strict=True))
    distance = 2.0 / (count - 1)
    centres = [-1.0 + j * distance for j in range(count)]
    if kind == "gaussian":
        return tuple(Membership(kind, (c, distance * _BETA_PER_DISTANCE)) for c in centres)
    half = distance / 4.0 if kind == "trapezoidal" else 0.0
    width = distance - 2.0 * half
    inner = [
        Membership(kind, (c - half, c + half, width, width) if half else (c, width, width))
        for c in centres[1:-1]
    ]
    left = Membership("trapezoidal", (-SHOULDER, -1.0 + half, width, width))
    right = Membership("trapezoidal", (1.0 - half, SHOULDER, width, width))
    return (left, *inner, right)
