"""Straight-line source text of a CasADi function, in C or in Python.

CasADi lists an SX function as instructions on numbered registers. Each instruction becomes one
assignment to a name of its own, in the same order for both languages, so that the native and the
portable FMU compute the same operations. CasADi's own C printer adds a page of symbols to each
file that nobody here calls.

This module refuses to know plants and FMUs.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isinf, isnan

import casadi as ca

from fmus.packaging.errors import PackagingError
from fmus.packaging.plant.instructions import Body, Instruction

_COMMON = {
    ca.OP_ADD: "{0} + {1}",
    ca.OP_SUB: "{0} - {1}",
    ca.OP_MUL: "{0} * {1}",
    ca.OP_NEG: "-{0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "2.0 * {0}",
    ca.OP_ASSIGN: "{0}",
}
_FUNCTIONS = {
    ca.OP_EXP: "exp",
    ca.OP_LOG: "log",
    ca.OP_POW: "pow",
    ca.OP_CONSTPOW: "pow",
    ca.OP_SQRT: "sqrt",
    ca.OP_SIN: "sin",
    ca.OP_COS: "cos",
    ca.OP_TAN: "tan",
    ca.OP_ASIN: "asin",
    ca.OP_ACOS: "acos",
    ca.OP_ATAN: "atan",
    ca.OP_ATAN2: "atan2",
    ca.OP_SINH: "sinh",
    ca.OP_COSH: "cosh",
    ca.OP_TANH: "tanh",
    ca.OP_ASINH: "asinh",
    ca.OP_ACOSH: "acosh",
    ca.OP_ATANH: "atanh",
    ca.OP_ERF: "erf",
    ca.OP_FLOOR: "floor",
    ca.OP_CEIL: "ceil",
    ca.OP_FMOD: "fmod",
    ca.OP_FABS: "fabs",
    ca.OP_COPYSIGN: "copysign",
    ca.OP_LOG1P: "log1p",
    ca.OP_EXPM1: "expm1",
    ca.OP_HYPOT: "hypot",
}
_COMPARISONS = {ca.OP_LT: "<", ca.OP_LE: "<=", ca.OP_EQ: "==", ca.OP_NE: "!="}


_BINARY_FUNCTIONS = frozenset({"pow", "atan2", "fmod", "copysign", "hypot"})


def _calls() -> dict[int, str]:
    """`name(a)` or `name(a, b)` for the functions that both languages call alike."""
    return {
        code: f"{name}({{0}}, {{1}})" if name in _BINARY_FUNCTIONS else f"{name}({{0}})"
        for code, name in _FUNCTIONS.items()
    }


C_TEMPLATES = {
    **_COMMON,
    **_calls(),
    **{code: f"({{0}} {sign} {{1}}) ? 1.0 : 0.0" for code, sign in _COMPARISONS.items()},
    ca.OP_DIV: "{0} / {1}",
    ca.OP_INV: "1.0 / {0}",
    # a comparison is one instruction, C's fmin a call; NaN in the second place passes on
    ca.OP_FMIN: "({0} < {1}) ? {0} : {1}",
    ca.OP_FMAX: "({0} > {1}) ? {0} : {1}",
    ca.OP_NOT: "({0} != 0.0) ? 0.0 : 1.0",
    ca.OP_AND: "({0} != 0.0 && {1} != 0.0) ? 1.0 : 0.0",
    ca.OP_OR: "({0} != 0.0 || {1} != 0.0) ? 1.0 : 0.0",
    ca.OP_SIGN: "({0} > 0.0) ? 1.0 : (({0} < 0.0) ? -1.0 : {0})",
    ca.OP_IF_ELSE_ZERO: "({0} != 0.0) ? {1} : 0.0",
}

# Python raises where C yields infinity or NaN; `div`, `pow` and the like of the portable runtime
# behave as C does, because both branches of an if_else are computed.
PYTHON_TEMPLATES = {
    **_COMMON,
    **_calls(),
    **{code: f"1.0 if {{0}} {sign} {{1}} else 0.0" for code, sign in _COMPARISONS.items()},
    ca.OP_DIV: "div({0}, {1})",
    ca.OP_INV: "div(1.0, {0})",
    ca.OP_FMIN: "{0} if {0} < {1} else {1}",
    ca.OP_FMAX: "{0} if {0} > {1} else {1}",
    ca.OP_NOT: "0.0 if {0} != 0.0 else 1.0",
    ca.OP_AND: "1.0 if {0} != 0.0 and {1} != 0.0 else 0.0",
    ca.OP_OR: "1.0 if {0} != 0.0 or {1} != 0.0 else 0.0",
    ca.OP_SIGN: "1.0 if {0} > 0.0 else (-1.0 if {0} < 0.0 else {0})",
    ca.OP_IF_ELSE_ZERO: "{1} if {0} != 0.0 else 0.0",
}


@dataclass(frozen=True)
class Language:
    """How one language writes an operation, an assignment and the constants no literal has."""

    templates: dict[int, str]
    assign: str
    store: str
    infinity: str
    not_a_number: str


C = Language(C_TEMPLATES, "const double {0} = {1};", "{0} = {1};", "INFINITY", "NAN")
PYTHON = Language(PYTHON_TEMPLATES, "{0} = {1}", "{0} = {1}", "inf", "nan")


def statements(body: Body, language: Language) -> str:
    """`body` as text, one indented line an instruction.

    Raises PackagingError for an operation that has no template.
    """
    return "\n".join(f"    {_line(one, language)}" for one in body)


def _line(one: Instruction, language: Language) -> str:
    operands = [o if isinstance(o, str) else _literal(o, language) for o in one.operands]
    if one.code == ca.OP_OUTPUT:
        return language.store.format(one.target, operands[0])
    if one.code not in language.templates:
        raise PackagingError(
            f"The equations use CasADi operation number {one.code}, which no FMU of ours can "
            "compute; write it with elementary functions."
        )
    return language.assign.format(one.target, language.templates[one.code].format(*operands))


def _literal(value: float, language: Language) -> str:
    if isnan(value):
        return language.not_a_number
    text = language.infinity if isinf(value) else repr(abs(value))
    return f"(-{text})" if value < 0 else text
