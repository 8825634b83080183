"""The operations of CasADi functions as lists, improved before a language prints them.

CasADi lists an SX function as instructions on numbered registers. Here each result gets a name of
its own, operands are names, elements of arrays, or numbers. What compilers may not do to floating
point is done here, once for all languages, so that these agree bit by bit: repeated divisions by
one variable become multiplications, and what depends on inputs and parameters only is computed once
a step (loop-invariant code motion).

This module refuses to know plants, languages and FMUs.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

Operand = str | float


@dataclass(frozen=True)
class Instruction:
    """`target` = operation `code` (CasADi's number) of `operands`; OP_OUTPUT stores one."""

    code: int
    operands: tuple[Operand, ...]
    target: str

    @property
    def divisor(self) -> Operand | None:
        """What it divides by."""
        return self.operands[-1] if self.code in (ca.OP_DIV, ca.OP_INV) else None


Body = list[Instruction]


def body_of(function: Any, inputs: Sequence[str], outputs: Sequence[str]) -> Body:
    """The instructions of a CasADi function.

    `inputs` and `outputs` name the arrays that take the place of its arguments; a sparse output is
    stored as its nonzeros, column by column.
    """
    return list(_read(function, inputs, outputs))


def with_reciprocals(body: Body, is_invariant: Callable[[Operand], bool] = lambda _: False) -> Body:
    """A division takes as long as five multiplications: where several instructions divide by one
    variable, or one that varies by an invariant, they multiply by the reciprocal, computed once."""
    divisors = Counter(one.divisor for one in body if isinstance(one.divisor, str))
    reciprocals: dict[str, str] = {}
    made: Body = []
    for one in body:
        divisor = one.divisor
        if isinstance(divisor, str) and (
            divisors[divisor] > 1
            or (is_invariant(divisor) and not all(is_invariant(o) for o in one.operands))
        ):
            if divisor not in reciprocals:
                reciprocals[divisor] = f"r{len(reciprocals)}"
                made.append(Instruction(ca.OP_INV, (divisor,), reciprocals[divisor]))
            operands = (*one.operands[:-1], reciprocals[divisor])
            code = ca.OP_MUL if one.code == ca.OP_DIV else ca.OP_ASSIGN
            one = replace(one, code=code, operands=operands)
        made.append(one)
    return made


def without_invariants(
    bodies: Sequence[Body], invariant: frozenset[str], array: str
) -> tuple[Body, list[Body]]:
    """What depends on the arrays in `invariant` only, taken out of all `bodies`.

    The first body returned stores it in `array`, from where the others read it; divisions are
    made reciprocals as in `with_reciprocals`.
    """
    extraction = _Extraction(invariant, array)
    rest = [extraction.rest_of(body) for body in bodies]
    computed = [Instruction(*key, name) for key, name in extraction.pool.items()]
    stored = [Instruction(ca.OP_OUTPUT, (n,), place) for n, place in extraction.places.items()]
    return computed + stored, rest


class _Extraction:
    """`pool`: names of invariant results by operation; `places`: elements of `array` by name."""

    def __init__(self, invariant: frozenset[str], array: str) -> None:
        self._invariant, self._array = invariant, array
        self.pool: dict[tuple[int, tuple[Operand, ...]], str] = {}
        self.places: dict[str, str] = {}

    def rest_of(self, body: Body) -> Body:
        """`body` without its invariants."""
        invariants: set[Operand] = set()

        def is_invariant(operand: Operand) -> bool:
            named = isinstance(operand, str)
            return not named or operand in invariants or _array(str(operand)) in self._invariant

        def moves(one: Instruction) -> bool:
            return one.code != ca.OP_OUTPUT and all(is_invariant(o) for o in one.operands)

        for one in body:
            if moves(one):
                invariants.add(one.target)
        names: dict[Operand, str] = {}
        rest: Body = []
        for one in with_reciprocals(body, is_invariant):
            if moves(one):
                invariants.add(one.target)  # a new reciprocal
                key = (one.code, tuple(names.get(o, o) for o in one.operands))
                names[one.target] = self.pool.setdefault(key, f"c{len(self.pool)}")
            else:
                operands = tuple(self._read(names[o]) if o in names else o for o in one.operands)
                rest.append(replace(one, operands=operands))
        return rest

    def _read(self, name: str) -> str:
        return self.places.setdefault(name, f"{self._array}[{len(self.places)}]")


def _array(operand: str) -> str:
    return operand.partition("[")[0]


def _read(function: Any, inputs: Sequence[str], outputs: Sequence[str]) -> Iterator[Instruction]:
    """The operations in order; reading an input or a constant is none."""
    registers: dict[int, Operand] = {}
    for k in range(function.n_instructions()):
        code = function.instruction_id(k)
        if code == ca.OP_OUTPUT:
            output, place = function.instruction_output(k)
            value = registers[function.instruction_input(k)[0]]
            yield Instruction(code, (value,), f"{outputs[output]}[{place}]")
            continue
        target = function.instruction_output(k)[0]
        if code == ca.OP_INPUT:
            argument, place = function.instruction_input(k)
            registers[target] = f"{inputs[argument]}[{place}]"
        elif code == ca.OP_CONST:
            registers[target] = float(function.instruction_constant(k))
        else:
            operands = tuple(registers[i] for i in function.instruction_input(k))
            yield Instruction(code, operands, f"t{k}")
            registers[target] = f"t{k}"
