"""Kernels of the Takagi–Sugeno model, eqs (2)–(4), (16)–(22) of Barragán et al.

A Takagi–Sugeno model is the fuzzy system of `inference` whose weights are affine in the
inputs. With x̃ = (1, x_1, …, x_n) and the firing w_l of the rules,

    y_l(x) = Σ_j a_jl·x̃_j,     h(x) = Σ_l w_l·y_l / Σ_l w_l                              (2)–(4)

so `fuzzy.infer` gives h and `fuzzy_gradient.infer_gradient` its derivatives:

    ∂h/∂a_jl = w_l·x̃_j / Σw                                                  (after (15))
    ∂h/∂σ    = Σ_l ∂w_l/∂σ·(y_l − h) / Σw, over all rules that name the function       (21)
    ∂h/∂x_j  = Σ_l w_l·a_jl/Σw + Σ_l ∂w_l/∂x_j·(y_l − h)/Σw

(21) as printed sums over the rules of one output; the sum over l' of w_l'·(a_l − a_l')·x̃ in it
is Σw·(y_l − h). Where no rule fires (Σw = 0, for which the paper has no rule) `out` keeps its
value, all derivatives are 0, and `model_outputs` reports how many outputs that concerns.

The model is two flat arrays: the structure s of `fuzzy.FuzzySystem` and θ = [σ | a], the
parameters of the membership functions and then the local models of output 1, of output 2, …,
each (a_0, a_1, …, a_n). `work` has length `model_work(s)`.

This module refuses to know what x and y are, and how θ is found.
"""

from __future__ import annotations

from controllers.core.block import Array
from controllers.fuzzy.gradient import infer_gradient
from controllers.fuzzy.inference import (
    FUNCTION_FIELDS,
    FUNCTIONS_AT,
    N_FUNCTIONS,
    N_INPUTS,
    N_OUTPUTS,
    N_RULES,
    N_WEIGHTS,
    WEIGHTS_AT,
    infer,
)
from controllers.fuzzy.membership import membership_gradient


def model_size(s: Array) -> int:
    """Number of components of θ."""
    return int(s[WEIGHTS_AT]) + int(s[N_WEIGHTS]) * (int(s[N_INPUTS]) + 1)


def model_work(s: Array) -> int:
    """Length of the work space: [φ = (σ | y_l) | ∂h/∂φ | μ | ∂h/∂μ | firing | strength]."""
    phi = int(s[WEIGHTS_AT]) + int(s[N_WEIGHTS])
    return 2 * phi + 2 * int(s[N_FUNCTIONS]) + int(s[N_RULES]) + int(s[N_WEIGHTS])


def local_outputs(s: Array, theta: Array, x: Array, phi: Array) -> None:
    """φ = (σ | y_l(x)): the parameters of the fuzzy system that the model is at x."""
    n = int(s[N_INPUTS])
    at = int(s[WEIGHTS_AT])
    for q in range(at):
        phi[q] = theta[q]
    for k in range(int(s[N_WEIGHTS])):
        place = at + (n + 1) * k
        total = theta[place]
        for j in range(n):
            total = total + theta[place + 1 + j] * x[j]
        phi[at + k] = total


def model_outputs(s: Array, theta: Array, x: Array, out: Array, work: Array) -> int:
    """h(x) into out (n_y,); returns how many outputs kept their value because no rule fires."""
    size = int(s[WEIGHTS_AT]) + int(s[N_WEIGHTS])
    mu = 2 * size
    firing = mu + 2 * int(s[N_FUNCTIONS])
    strength = firing + int(s[N_RULES])
    local_outputs(s, theta, x, work)
    return infer(s, work[:size], x, work[mu:], work[firing:strength], work[strength:], out)


def output_gradient(s: Array, x: Array, out: Array, output: int, work: Array) -> None:
    """∂h/∂φ and ∂h/∂μ of one output into `work`, after `model_outputs` at the same point."""
    size = int(s[WEIGHTS_AT]) + int(s[N_WEIGHTS])
    mu = 2 * size
    dmu = mu + int(s[N_FUNCTIONS])
    firing = dmu + int(s[N_FUNCTIONS])
    strength = firing + int(s[N_RULES])
    infer_gradient(
        s, work[:size], x, work[mu:dmu], work[firing:strength], work[strength:], out, output,
        work[dmu:firing], work[size:mu],
    )  # fmt: skip


def model_jacobian(s: Array, theta: Array, x: Array, out: Array, H: Array, work: Array) -> None:
    """H = ∂h/∂θ (n_y·n_θ,) row by row, after `model_outputs` at the same point."""
    n = int(s[N_INPUTS])
    at = int(s[WEIGHTS_AT])
    n_local = int(s[N_WEIGHTS])
    size = at + n_local
    n_theta = at + n_local * (n + 1)
    for o in range(int(s[N_OUTPUTS])):
        output_gradient(s, x, out, o, work)
        row = H[o * n_theta : (o + 1) * n_theta]
        for q in range(at):
            row[q] = work[size + q]
        for k in range(n_local):
            share = work[size + at + k]
            place = at + (n + 1) * k
            row[place] = share
            for j in range(n):
                row[place + 1 + j] = share * x[j]


def model_slopes(s: Array, theta: Array, x: Array, out: Array, G: Array, work: Array) -> None:
    """G = ∂h/∂x (n_y·n,) row by row, after `model_outputs` at the same point."""
    n = int(s[N_INPUTS])
    at = int(s[WEIGHTS_AT])
    size = at + int(s[N_WEIGHTS])
    dmu = 2 * size + int(s[N_FUNCTIONS])
    for o in range(int(s[N_OUTPUTS])):
        output_gradient(s, x, out, o, work)
        row = G[o * n : (o + 1) * n]
        for j in range(n):
            row[j] = 0.0
            for k in range(int(s[N_WEIGHTS])):
                row[j] = row[j] + work[size + at + k] * theta[at + (n + 1) * k + 1 + j]
        for f in range(int(s[N_FUNCTIONS])):
            if work[dmu + f] != 0.0:
                entry = FUNCTIONS_AT + FUNCTION_FIELDS * f
                j = int(s[entry])
                place = int(s[entry + 2])
                slope = membership_gradient(
                    int(s[entry + 1]), x[j], theta[place:], work[size + place :]
                )
                row[j] = row[j] + work[dmu + f] * slope
