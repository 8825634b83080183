"""Exact derivatives of a fuzzy output to all its tunable parameters, (42)–(47) of the paper.

With S = Σ mf(w_k) the parts are

    ∂U/∂w_k     = mf(w_k)/S                                                          (42)
    ∂U/∂mf(w_k) = Σ_j mf(w_j)·(w_k − w_j)/S² = (w_k − U)/S                           (44)
    ∂U/∂μ_j     = Σ_r ∂U/∂mf(w_k(r))·∂φ_r/∂μ_j, over *all* rules r that name function j

∂φ_r/∂μ_j is 1 where μ_j is the smallest of the rule (the first of equals) and 0 elsewhere for
min; the product of the other memberships for product. With max aggregation only the rule that
attains the maximum (the first of equals) counts. A rule that does not fire contributes nothing.
"""

from __future__ import annotations

from controllers.core.block import Array
from controllers.fuzzy.inference import (
    AGGREGATION,
    FUNCTION_FIELDS,
    FUNCTIONS_AT,
    IMPLICATION,
    N_FUNCTIONS,
    N_INPUTS,
    N_OUTPUTS,
    N_RULES,
    OUTPUTS_AT,
    PRODUCT,
    RULES_AT,
    SUM,
    WEIGHTS_AT,
)
from controllers.fuzzy.membership import membership_gradient


def rule_derivative(s: Array, row: int, mu: Array, firing: float, position: int) -> float:
    """∂φ/∂μ of the function at `position` of the rule at `row` with height `firing`."""
    n_inputs = int(s[N_INPUTS])
    if int(s[IMPLICATION]) == PRODUCT:
        others = 1.0
        for i in range(n_inputs):
            j = int(s[row + i])
            if i != position and j >= 0:
                others = others * mu[j]
        return others
    for i in range(n_inputs):
        j = int(s[row + i])
        if j >= 0 and mu[j] == firing:
            if i == position:
                return 1.0
            return 0.0
    return 0.0


def leads(s: Array, rule: int, output: int, firing: Array, strength: float) -> bool:
    """Whether `rule` determines the strength of its weight: always for sum, else the first max."""
    if int(s[AGGREGATION]) == SUM:
        return True
    if firing[rule] != strength:
        return False
    n_inputs = int(s[N_INPUTS])
    width = n_inputs + int(s[N_OUTPUTS])
    column = int(s[RULES_AT]) + n_inputs + output
    for earlier in range(rule):
        if firing[earlier] == strength and s[column + width * earlier] == s[column + width * rule]:
            return False
    return True


def infer_gradient(
    s: Array,
    theta: Array,
    x: Array,
    mu: Array,
    firing: Array,
    strength: Array,
    out: Array,
    output: int,
    dmu: Array,
    gradient: Array,
) -> None:
    """∂U/∂θ of one output into `gradient` (shape of θ), after `infer` at the same point.

    `dmu` (n_functions) is work space and holds ∂U/∂μ afterwards.
    """
    n_inputs = int(s[N_INPUTS])
    width = n_inputs + int(s[N_OUTPUTS])
    weights_at = int(s[WEIGHTS_AT])
    for place in range(theta.shape[0]):
        gradient[place] = 0.0
    for j in range(int(s[N_FUNCTIONS])):
        dmu[j] = 0.0
    first = int(s[int(s[OUTPUTS_AT]) + 2 * output])
    count = int(s[int(s[OUTPUTS_AT]) + 2 * output + 1])
    total = 0.0
    for k in range(first, first + count):
        total = total + strength[k]
    if total == 0.0:
        return
    for k in range(first, first + count):
        gradient[weights_at + k] = strength[k] / total
    for r in range(int(s[N_RULES])):
        row = int(s[RULES_AT]) + width * r
        k = int(s[row + n_inputs + output])
        if k >= 0 and firing[r] > 0.0 and leads(s, r, output, firing, strength[k]):
            slope = (theta[weights_at + k] - out[output]) / total
            for i in range(n_inputs):
                j = int(s[row + i])
                if j >= 0:
                    dmu[j] = dmu[j] + slope * rule_derivative(s, row, mu, firing[r], i)
    chain(s, theta, x, dmu, gradient)


def chain(s: Array, theta: Array, x: Array, dmu: Array, gradient: Array) -> None:
    """∂U/∂μ·∂μ/∂(parameters) for all functions, into `gradient`."""
    weights_at = int(s[WEIGHTS_AT])
    n_functions = int(s[N_FUNCTIONS])
    for j in range(n_functions):
        if dmu[j] != 0.0:
            row = FUNCTIONS_AT + FUNCTION_FIELDS * j
            place = int(s[row + 2])
            end = weights_at
            if j + 1 < n_functions:
                end = int(s[row + FUNCTION_FIELDS + 2])
            membership_gradient(int(s[row + 1]), x[int(s[row])], theta[place:], gradient[place:])
            for q in range(place, end):
                gradient[q] = gradient[q] * dmu[j]
