"""Mamdani inference with weighted outputs, eqs (3)–(7) of Ahn & Truong 2009, in general form.

Any number of inputs, membership functions and outputs. Rule r names one membership function per
input (or none: that input does not matter) and one weight per output (or none: the rule does not
speak of that output). With memberships μ of the inputs,

    firing      φ_r = min or product of the μ that rule r names           (7), or product
    strength    mf(w_k) = sum or max of φ_r over the rules that name w_k  (5), or max
    output      U = Σ mf(w_k)·w_k / Σ mf(w_k)                             (4)

U is limited to the range of the weights with strength above 0, which rounding alone can leave:
so with equal weights U is that weight exactly. **Where no rule fires (Σ = 0) the output keeps the
value it had**, its gradient is 0, and `infer` reports it.

Two flat arrays describe a system: the structure s (sizes, codes, tables; never changes) and θ,
what can be tuned, in the order of (34): the parameters of the functions of input 1, of input 2,
…, then the weights of output 1, of output 2, … Work arrays: mu (n_functions), firing (n_rules),
strength (n_weights). The derivatives (42), (44), (45), (47) are in `gradient`.

This module refuses to know what the inputs and outputs mean.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.core.block import Array
from controllers.core.errors import ControllerError, require, require_choice, require_finite
from controllers.fuzzy.membership import KINDS, PARAMETERS, membership

# Head of the structure array s.
N_INPUTS, N_FUNCTIONS, N_RULES, N_OUTPUTS, N_WEIGHTS = range(5)
IMPLICATION, AGGREGATION = 5, 6
WEIGHTS_AT, RULES_AT, OUTPUTS_AT = 7, 8, 9  # in θ; in s; in s
FUNCTIONS_AT = 10  # the table of functions follows the head: (input, kind, place in θ) each
FUNCTION_FIELDS = 3

MIN, PRODUCT = 0, 1
SUM, MAX = 0, 1
IMPLICATIONS = {"min": MIN, "product": PRODUCT}
AGGREGATIONS = {"sum": SUM, "max": MAX}


def memberships(s: Array, theta: Array, x: Array, mu: Array) -> None:
    """Degrees of all membership functions for the inputs x, into mu."""
    for j in range(int(s[N_FUNCTIONS])):
        row = FUNCTIONS_AT + FUNCTION_FIELDS * j
        place = int(s[row + 2])
        mu[j] = membership(int(s[row + 1]), x[int(s[row])], theta[place:])


def fire(s: Array, mu: Array, firing: Array) -> None:
    """Firing of every rule, (7) with min or product."""
    n_inputs = int(s[N_INPUTS])
    width = n_inputs + int(s[N_OUTPUTS])
    implication = int(s[IMPLICATION])
    for r in range(int(s[N_RULES])):
        row = int(s[RULES_AT]) + width * r
        height = 1.0
        for i in range(n_inputs):
            j = int(s[row + i])
            if j >= 0:
                if implication == PRODUCT:
                    height = height * mu[j]
                elif mu[j] < height:
                    height = mu[j]
        firing[r] = height


def aggregate(s: Array, firing: Array, strength: Array) -> None:
    """Strength mf(w_k) of every weight, (5) with sum or max."""
    n_inputs = int(s[N_INPUTS])
    n_outputs = int(s[N_OUTPUTS])
    aggregation = int(s[AGGREGATION])
    for k in range(int(s[N_WEIGHTS])):
        strength[k] = 0.0
    for r in range(int(s[N_RULES])):
        row = int(s[RULES_AT]) + (n_inputs + n_outputs) * r + n_inputs
        for o in range(n_outputs):
            k = int(s[row + o])
            if k >= 0:
                if aggregation == SUM:
                    strength[k] = strength[k] + firing[r]
                elif firing[r] > strength[k]:
                    strength[k] = firing[r]


def defuzzify(weights: Array, strength: Array, first: int, count: int, held: float) -> float:
    """U of (4) over weights[first:first+count], or `held` where nothing fires."""
    total = 0.0
    moment = 0.0
    low = 0.0
    high = 0.0
    for k in range(first, first + count):
        if strength[k] > 0.0:
            if total == 0.0 or weights[k] < low:
                low = weights[k]
            if total == 0.0 or weights[k] > high:
                high = weights[k]
            total = total + strength[k]
            moment = moment + strength[k] * weights[k]
    if total == 0.0:
        return held
    value = moment / total
    if value < low:
        return low
    if value > high:
        return high
    return value


def infer(
    s: Array, theta: Array, x: Array, mu: Array, firing: Array, strength: Array, out: Array
) -> int:
    """Outputs for the inputs x; returns how many outputs kept their value (Σ = 0)."""
    memberships(s, theta, x, mu)
    fire(s, mu, firing)
    aggregate(s, firing, strength)
    weights = theta[int(s[WEIGHTS_AT]) :]
    silent = 0
    for o in range(int(s[N_OUTPUTS])):
        row = int(s[OUTPUTS_AT]) + 2 * o
        first = int(s[row])
        count = int(s[row + 1])
        total = 0.0
        for k in range(first, first + count):
            total = total + strength[k]
        if total == 0.0:
            silent = silent + 1
        out[o] = defuzzify(weights, strength, first, count, out[o])
    return silent


@dataclass(frozen=True)
class Membership:
    """One membership function: kind of `membership.KINDS` and its parameters in their order."""

    kind: str
    parameters: tuple[float, ...]

    def __post_init__(self) -> None:
        """Raise `ControllerError` for an unknown kind or parameters that do not fit it."""
        require_choice("Membership.kind", self.kind, KINDS)
        names = PARAMETERS[self.kind]
        where = f"Membership.parameters of kind {self.kind!r}"
        expected = f"{len(names)} numbers ({', '.join(names)})"
        require(len(self.parameters) == len(names), where, expected, self.parameters)
        for name, value in zip(names, self.parameters, strict=True):
            require_finite(f"{where}: {name}", value)
            if name.startswith("b"):
                require(value > 0.0, f"{where}: {name}", "a width greater than 0", value)


@dataclass(frozen=True)
class Rule:
    """Antecedents: an index into each input's functions; consequents: into each output's weights.

    −1 in an antecedent: this input does not matter; in a consequent: no word on this output.
    """

    antecedents: tuple[int, ...]
    consequents: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class FuzzySystem:
    """A fuzzy system as data; `structure()` and `theta()` are what the kernels read.

    inputs   the membership functions of each input
    weights  the weights of each output
    """

    inputs: tuple[tuple[Membership, ...], ...]
    weights: tuple[tuple[float, ...], ...]
    rules: tuple[Rule, ...]
    implication: str = "min"
    aggregation: str = "sum"

    def __post_init__(self) -> None:
        """Raise `ControllerError` where rules, functions and weights do not fit together."""
        require_choice("FuzzySystem.implication", self.implication, IMPLICATIONS)
        require_choice("FuzzySystem.aggregation", self.aggregation, AGGREGATIONS)
        for name in ("inputs", "weights", "rules"):
            require(len(getattr(self, name)) > 0, f"FuzzySystem.{name}", "at least one", ())
        for number, rule in enumerate(self.rules, start=1):
            _require_indices(f"rule {number}: antecedents", rule.antecedents, self.inputs)
            _require_indices(f"rule {number}: consequents", rule.consequents, self.weights)

    @property
    def n_functions(self) -> int:
        """Membership functions of all inputs together."""
        return sum(len(functions) for functions in self.inputs)

    @property
    def n_weights(self) -> int:
        """Weights of all outputs together."""
        return sum(len(weights) for weights in self.weights)

    def theta(self) -> Array:
        """Tunable parameters in the order of (34)."""
        functions = [q for one in self.inputs for function in one for q in function.parameters]
        return np.array(functions + [w for one in self.weights for w in one], dtype=np.float64)

    def structure(self) -> Array:
        """Sizes, codes and tables; see the module's constants."""
        table: list[int] = []
        place = 0
        for i, functions in enumerate(self.inputs):
            for function in functions:
                table += [i, KINDS[function.kind], place]
                place += len(function.parameters)
        first_function = np.cumsum([0, *(len(functions) for functions in self.inputs)])
        first_weight = np.cumsum([0, *(len(weights) for weights in self.weights)])
        rules: list[int] = []
        for rule in self.rules:
            rules += [-1 if j < 0 else int(first_function[i]) + j
                      for i, j in enumerate(rule.antecedents)]  # fmt: skip
            rules += [-1 if k < 0 else int(first_weight[o]) + k
                      for o, k in enumerate(rule.consequents)]  # fmt: skip
        outputs = [n for o, w in enumerate(self.weights) for n in (int(first_weight[o]), len(w))]
        rules_at = FUNCTIONS_AT + len(table)
        head = [0] * FUNCTIONS_AT
        head[N_INPUTS], head[N_FUNCTIONS] = len(self.inputs), self.n_functions
        head[N_RULES], head[N_OUTPUTS] = len(self.rules), len(self.weights)
        head[N_WEIGHTS], head[WEIGHTS_AT] = self.n_weights, place
        head[IMPLICATION] = IMPLICATIONS[self.implication]
        head[AGGREGATION] = AGGREGATIONS[self.aggregation]
        head[RULES_AT], head[OUTPUTS_AT] = rules_at, rules_at + len(rules)
        return np.array(head + table + rules + outputs, dtype=np.float64)

    def evaluate(self, *x: float) -> Array:
        """Outputs (n_outputs,) at one point; NaN where no rule fires."""
        require(len(x) == len(self.inputs), "FuzzySystem.evaluate", f"{len(self.inputs)} inputs", x)
        out = np.full(len(self.weights), np.nan)
        work = (self.n_functions, len(self.rules), self.n_weights)
        mu, firing, strength = (np.zeros(n) for n in work)
        infer(self.structure(), self.theta(), np.array(x, float), mu, firing, strength, out)
        return out


def _require_indices(
    where: str, indices: tuple[int, ...], tables: tuple[tuple[object, ...], ...]
) -> None:
    if len(indices) != len(tables):
        raise ControllerError(f"{where}: expected {len(tables)} indices, received {indices!r}.")
    for index, table in zip(indices, tables, strict=True):
        require(-1 <= index < len(table), where, f"indices from -1 to {len(table) - 1}", index)


def grid_rules(table: tuple[tuple[int, ...], ...]) -> tuple[Rule, ...]:
    """Rules of a two-input one-output table: entry [i][j] is the weight for classes i and j."""
    return tuple(Rule((i, j), (k,)) for i, row in enumerate(table) for j, k in enumerate(row))


def triangular_partition(count: int) -> tuple[Membership, ...]:
    """`count` triangles of equal shape at equal intervals on [0, 1], as Fig. 6a; they sum to 1."""
    require(count >= 2, "triangular_partition", "at least 2 functions", count)
    width = 1.0 / (count - 1)
    return tuple(Membership("triangular", (j * width, width, width)) for j in range(count))
