"""Straight-line source text of a CasADi function, in C or in Python.

CasADi lists an SX function as instructions on numbered registers. Each instruction becomes one
assignment to a name of its own, in the same order for both languages, so that the native and the
portable FMU compute the same operations. CasADi's own C printer adds a page of symbols to each
file that nobody here calls.

This module refuses to know plants and FMUs.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from math import isinf, isnan
from typing import Any

import casadi as ca

from fmus.packaging.errors import PackagingError

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


@dataclass(frozen=True)
class _Instruction:
    """One operation: `code` of CasADi, names or literals of its operands, name of its result."""

    code: int
    operands: tuple[str, ...]
    target: str

    @property
    def divisor(self) -> str | None:
        """What it divides by."""
        return self.operands[-1] if self.code in (ca.OP_DIV, ca.OP_INV) else None


def statements(function: Any, language: Language, inputs: list[str], outputs: list[str]) -> str:
    """The body of `function`: one indented line an instruction.

    `inputs` and `outputs` name the arrays that take the place of the function's arguments; a
    sparse output is stored as its nonzeros, column by column. Where several instructions divide by
    one variable they multiply by its reciprocal, computed once: a division takes as long as five
    multiplications. Raises PackagingError for an operation that has no template.
    """
    instructions = list(_instructions(function, language, inputs, outputs))
    divisors = Counter(i.divisor for i in instructions if i.divisor and i.divisor[0].isalpha())
    repeated = {name for name, count in divisors.items() if count > 1}
    return "\n".join(f"    {line}" for line in _lines(instructions, language, repeated))


def _lines(
    instructions: list[_Instruction], language: Language, repeated: set[str]
) -> Iterator[str]:
    reciprocals: dict[str, str] = {}
    for one in instructions:
        divisor, code, operands = one.divisor, one.code, one.operands
        if divisor in repeated:
            if divisor not in reciprocals:
                reciprocals[divisor] = f"r{len(reciprocals)}"
                inverse = _operation(ca.OP_INV, (divisor,), language)
                yield language.assign.format(reciprocals[divisor], inverse)
            operands = (*operands[:-1], reciprocals[divisor])
            code = ca.OP_MUL if code == ca.OP_DIV else ca.OP_ASSIGN
        if code == ca.OP_OUTPUT:
            yield language.store.format(one.target, operands[0])
        else:
            yield language.assign.format(one.target, _operation(code, operands, language))


def _instructions(
    function: Any, language: Language, inputs: list[str], outputs: list[str]
) -> Iterator[_Instruction]:
    """The operations in order; reading an input or a constant is none."""
    registers: dict[int, str] = {}
    for k in range(function.n_instructions()):
        code = function.instruction_id(k)
        if code == ca.OP_OUTPUT:
            output, place = function.instruction_output(k)
            value = registers[function.instruction_input(k)[0]]
            yield _Instruction(code, (value,), f"{outputs[output]}[{place}]")
            continue
        target = function.instruction_output(k)[0]
        if code == ca.OP_INPUT:
            argument, place = function.instruction_input(k)
            registers[target] = f"{inputs[argument]}[{place}]"
        elif code == ca.OP_CONST:
            registers[target] = _literal(function.instruction_constant(k), language)
        else:
            operands = tuple(registers[i] for i in function.instruction_input(k))
            yield _Instruction(code, operands, f"t{k}")
            registers[target] = f"t{k}"


def _operation(code: int, operands: tuple[str, ...], language: Language) -> str:
    if code not in language.templates:
        raise PackagingError(
            f"The equations use CasADi operation number {code}, which no FMU of ours can compute; "
            "write it with elementary functions."
        )
    return language.templates[code].format(*operands)


def _literal(value: float, language: Language) -> str:
    if isnan(value):
        return language.not_a_number
    text = language.infinity if isinf(value) else repr(abs(value))
    return f"(-{text})" if value < 0 else text
