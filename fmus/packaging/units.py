"""Unit strings and what they mean in FMI: exponents of SI base units, factor and offset.

    value in SI base units = factor * value + offset

Written as in the plants: products with `.` or `*`, quotients with `/`, exponents `m3` or `m^3` or
`s-1`, parentheses, SI prefixes, "1" for no unit: "N.m/(rad/s)", "kg.m2", "1/s", "m3/(s.Pa)".
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field

from fmus.packaging.errors import PackagingError

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True)
class BaseUnit:
    """Exponents by base unit (those that are not zero), factor and offset to SI base units."""

    exponents: dict[str, int] = field(default_factory=dict)
    factor: float = 1.0
    offset: float = 0.0


_DERIVED: dict[str, BaseUnit] = {
    **{name: BaseUnit({name: 1}) for name in BASE_UNITS},
    "1": BaseUnit(),
    "-": BaseUnit(),
    "%": BaseUnit({}, 0.01),
    "g": BaseUnit({"kg": 1}, 1e-3),
    "N": BaseUnit({"kg": 1, "m": 1, "s": -2}),
    "Pa": BaseUnit({"kg": 1, "m": -1, "s": -2}),
    "J": BaseUnit({"kg": 1, "m": 2, "s": -2}),
    "W": BaseUnit({"kg": 1, "m": 2, "s": -3}),
    "C": BaseUnit({"A": 1, "s": 1}),
    "V": BaseUnit({"kg": 1, "m": 2, "s": -3, "A": -1}),
    "Ohm": BaseUnit({"kg": 1, "m": 2, "s": -3, "A": -2}),
    "H": BaseUnit({"kg": 1, "m": 2, "s": -2, "A": -2}),
    "F": BaseUnit({"kg": -1, "m": -2, "s": 4, "A": 2}),
    "Wb": BaseUnit({"kg": 1, "m": 2, "s": -2, "A": -1}),
    "T": BaseUnit({"kg": 1, "s": -2, "A": -1}),
    "Hz": BaseUnit({"s": -1}),
    "deg": BaseUnit({"rad": 1}, 0.017453292519943295),
    "rev": BaseUnit({"rad": 1}, 6.283185307179586),
    "bar": BaseUnit({"kg": 1, "m": -1, "s": -2}, 1e5),
    "L": BaseUnit({"m": 3}, 1e-3),
    "l": BaseUnit({"m": 3}, 1e-3),
    "min": BaseUnit({"s": 1}, 60.0),
    "h": BaseUnit({"s": 1}, 3600.0),
    "degC": BaseUnit({"K": 1}, 1.0, 273.15),
}
_PREFIXES = {"G": 1e9, "M": 1e6, "k": 1e3, "c": 1e-2, "m": 1e-3, "u": 1e-6, "n": 1e-9}
_TOKEN = re.compile(r"([A-Za-z]+|[1%.*/()·])(?:\^?(-?\d+))?")


def base_unit(unit: str) -> BaseUnit:
    """The meaning of `unit`; raises PackagingError naming the part that is not understood."""
    if unit in _DERIVED:
        return _DERIVED[unit]
    exponents: Counter[str] = Counter()
    factor = 1.0
    for name, power in _powers(unit):
        part = _symbol(name, unit)
        factor *= part.factor**power
        for base, exponent in part.exponents.items():
            exponents[base] += exponent * power
    return BaseUnit({base: exponents[base] for base in BASE_UNITS if exponents[base]}, factor)


def _symbol(name: str, unit: str) -> BaseUnit:
    if name in _DERIVED:
        part = _DERIVED[name]
        if part.offset:
            raise PackagingError(f"The unit {unit!r} multiplies {name!r}, which has an offset.")
        return part
    prefix, rest = name[:1], name[1:]
    if prefix in _PREFIXES and rest in _DERIVED and rest not in ("1", "-", "%"):
        part = _DERIVED[rest]
        return BaseUnit(part.exponents, part.factor * _PREFIXES[prefix])
    raise PackagingError(
        f"The unit {unit!r} contains {name!r}, which is unknown; known are {sorted(_DERIVED)} "
        f"with the prefixes {sorted(_PREFIXES)}."
    )


def _powers(unit: str) -> list[tuple[str, int]]:
    """Symbols with their powers; `/` binds the next symbol or parenthesis only, left to right."""
    powers: list[tuple[str, int]] = []
    signs, pending, operand_next, position = [1], 1, True, 0
    while position < len(unit):
        token = _TOKEN.match(unit, position)
        symbol = token.group(1) if token else ""
        starts_operand = symbol == "(" or symbol[:1].isalpha() or symbol in ("1", "%")
        closes_nothing = symbol == ")" and len(signs) == 1
        if token is None or starts_operand != operand_next or closes_nothing:
            raise PackagingError(f"The unit {unit!r} is not understood from {unit[position:]!r}.")
        position = token.end()
        if symbol == "(":
            signs.append(signs[-1] * pending)
            pending = 1
        elif symbol == ")":
            signs.pop()
        elif starts_operand:
            powers.append((symbol, int(token.group(2) or 1) * signs[-1] * pending))
            operand_next = False
        else:
            pending = -1 if symbol == "/" else 1
            operand_next = True
    if operand_next or len(signs) > 1:
        raise PackagingError(f"The unit {unit!r} ends too early.")
    return powers
