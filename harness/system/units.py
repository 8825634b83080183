"""Units as FMI states them: exponents of base units, a factor and an offset.

    base value = factor * value + offset

A wire between two units of equal exponents is converted; different exponents are an error. A unit
that is not stated ("" or None) takes that of its neighbour. Units without a definition in the FMU
are looked up in `KNOWN` and may be composed with "." and "/", as in "N.m", "cm3/s", "kg/m3".
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from harness.errors import UnitError

Exponents = tuple[int, ...]
BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_NONE: Exponents = (0,) * 8


@dataclass(frozen=True)
class Unit:
    """A unit; `exponents` of (kg, m, s, A, K, mol, cd, rad) are None when nothing defines them."""

    name: str
    exponents: Exponents | None = None
    factor: float = 1.0
    offset: float = 0.0


def _base(name: str, factor: float = 1.0, offset: float = 0.0, /, **exponents: int) -> Unit:
    return Unit(name, tuple(exponents.get(n, 0) for n in BASE_UNITS), factor, offset)


KNOWN: Mapping[str, Unit] = {
    unit.name: unit
    for unit in (
        _base("1"),
        _base("%", 0.01),
        _base("kg", kg=1), _base("g", 1e-3, kg=1), _base("t", 1e3, kg=1),
        _base("m", m=1), _base("mm", 1e-3, m=1), _base("cm", 1e-2, m=1), _base("km", 1e3, m=1),
        _base("s", s=1), _base("ms", 1e-3, s=1), _base("us", 1e-6, s=1), _base("min", 60.0, s=1),
        _base("h", 3600.0, s=1), _base("A", A=1), _base("mA", 1e-3, A=1), _base("K", K=1),
        _base("degC", 1.0, 273.15, K=1), _base("mol", mol=1), _base("cd", cd=1),
        _base("rad", rad=1), _base("deg", math.pi / 180.0, rad=1),
        _base("rev", 2.0 * math.pi, rad=1), _base("Hz", s=-1),
        _base("l", 1e-3, m=3), _base("L", 1e-3, m=3),
        _base("N", kg=1, m=1, s=-2), _base("kN", 1e3, kg=1, m=1, s=-2),
        _base("Pa", kg=1, m=-1, s=-2), _base("kPa", 1e3, kg=1, m=-1, s=-2),
        _base("MPa", 1e6, kg=1, m=-1, s=-2), _base("bar", 1e5, kg=1, m=-1, s=-2),
        _base("J", kg=1, m=2, s=-2), _base("W", kg=1, m=2, s=-3), _base("kW", 1e3, kg=1, m=2, s=-3),
        _base("V", kg=1, m=2, s=-3, A=-1), _base("mV", 1e-3, kg=1, m=2, s=-3, A=-1),
        _base("Ohm", kg=1, m=2, s=-3, A=-2), _base("Wb", kg=1, m=2, s=-2, A=-1),
        _base("C", s=1, A=1), _base("F", kg=-1, m=-2, s=4, A=2), _base("H", kg=1, m=2, s=-2, A=-2),
    )
}  # fmt: skip
"""The units that may be named without a definition."""

_TERM = re.compile(r"^([A-Za-z%]+|1)(?:\^?(-?\d+))?$")


def parse_unit(name: str, defined: Mapping[str, Unit] | None = None) -> Unit:
    """The unit of that name: as the FMU defines it, else from `KNOWN`, else without exponents."""
    if defined and name in defined and defined[name].exponents is not None:
        return defined[name]
    if name in KNOWN:
        return KNOWN[name]
    if re.search(r"\([^)]*/", name):  # a quotient in a denominator: FMI does not say what it means
        return Unit(name)
    factor, total = 1.0, _NONE
    for position, quotient in enumerate(name.replace("(", "").replace(")", "").split("/")):
        for term in re.split(r"[.*·]", quotient):
            match = _TERM.match(term.strip())
            if match is None or match[1] not in KNOWN or KNOWN[match[1]].offset:
                return Unit(name)
            power = int(match[2] or 1) * (1 if position == 0 else -1)
            known = KNOWN[match[1]]
            assert known.exponents is not None
            factor *= known.factor**power
            total = tuple(a + power * b for a, b in zip(total, known.exponents, strict=True))
    return Unit(name, total, factor)


def conversion(source: Unit | None, target: Unit | None) -> tuple[float, float]:
    """The doubles nearest to `exact_conversion`; raises `UnitError`."""
    factor, offset = exact_conversion(source, target)
    return float(factor), float(offset)


def exact_conversion(source: Unit | None, target: Unit | None) -> tuple[Fraction, Fraction]:
    """Factor and offset with which a value in `source` becomes one in `target`, exact in the units'
    own numbers.

    (1, 0) where either is not stated, or both have the same name. Raises `UnitError` when the
    exponents differ, or when different names cannot be compared for want of a definition.
    """
    if source is None or target is None or not source.name or not target.name or source == target:
        return Fraction(1), Fraction(0)
    if source.exponents is None or target.exponents is None:
        if source.name == target.name:
            return Fraction(1), Fraction(0)
        unknown = source if source.exponents is None else target
        raise UnitError(
            f"unit {unknown.name!r} is not defined, so {source.name!r} cannot be converted to "
            f"{target.name!r}"
        )
    if source.exponents != target.exponents:
        raise UnitError(
            f"unit {source.name!r} ({_dimension(source)}) cannot be converted to {target.name!r} "
            f"({_dimension(target)})"
        )
    if target.factor == 0.0:
        raise UnitError(f"unit {target.name!r} has the factor 0, so nothing converts to it")
    numbers = (source.factor, source.offset, target.factor, target.offset)
    if not all(map(math.isfinite, numbers)):
        raise UnitError(f"unit {source.name!r} or {target.name!r} has an infinite factor or offset")
    f_s, o_s, f_t, o_t = map(Fraction, numbers)
    return f_s / f_t, (o_s - o_t) / f_t


def _dimension(unit: Unit) -> str:
    assert unit.exponents is not None
    terms = [
        f"{n}{e if e != 1 else ''}" for n, e in zip(BASE_UNITS, unit.exponents, strict=True) if e
    ]
    return ".".join(terms) or "dimensionless"
