"""Unit strings against the SI's own definitions."""

import pytest

from fmus.packaging.errors import PackagingError
from fmus.packaging.units import BaseUnit, base_unit

CASES = [
    ("1", {}, 1.0, 0.0),
    ("N", {"kg": 1, "m": 1, "s": -2}, 1.0, 0.0),
    ("N.m", {"kg": 1, "m": 2, "s": -2}, 1.0, 0.0),
    ("N·m/(rad/s)", {"kg": 1, "m": 2, "s": -1, "rad": -1}, 1.0, 0.0),
    ("N.m.s/rad", {"kg": 1, "m": 2, "s": -1, "rad": -1}, 1.0, 0.0),
    ("m3/s", {"m": 3, "s": -1}, 1.0, 0.0),
    ("m^3/s", {"m": 3, "s": -1}, 1.0, 0.0),
    ("m3/(s.Pa)", {"kg": -1, "m": 4, "s": 1}, 1.0, 0.0),
    ("m3/s/Pa", {"kg": -1, "m": 4, "s": 1}, 1.0, 0.0),
    ("kg.m2", {"kg": 1, "m": 2}, 1.0, 0.0),
    ("m.s-2", {"m": 1, "s": -2}, 1.0, 0.0),
    ("1/s", {"s": -1}, 1.0, 0.0),
    ("m/m", {}, 1.0, 0.0),
    ("kN", {"kg": 1, "m": 1, "s": -2}, 1e3, 0.0),
    ("MPa", {"kg": 1, "m": -1, "s": -2}, 1e6, 0.0),
    ("bar", {"kg": 1, "m": -1, "s": -2}, 1e5, 0.0),
    ("mm2", {"m": 2}, 1e-6, 0.0),
    ("min", {"s": 1}, 60.0, 0.0),
    ("rev/min", {"s": -1, "rad": 1}, 0.10471975511965977, 0.0),
    ("degC", {"K": 1}, 1.0, 273.15),
    ("V.s/rad", {"kg": 1, "m": 2, "s": -2, "A": -1, "rad": -1}, 1.0, 0.0),
    ("N.m/A", {"kg": 1, "m": 2, "s": -2, "A": -1}, 1.0, 0.0),
    ("m3/(s.Pa(1/2))", None, 0.0, 0.0),
    ("furlong", None, 0.0, 0.0),
    ("degC/s", None, 0.0, 0.0),
    ("(m", None, 0.0, 0.0),
    ("m)", None, 0.0, 0.0),
    ("", None, 0.0, 0.0),
]


@pytest.mark.parametrize(("text", "exponents", "factor", "offset"), CASES)
def test_meaning(text: str, exponents: dict[str, int] | None, factor: float, offset: float) -> None:
    if exponents is None:
        with pytest.raises(PackagingError):
            base_unit(text)
        return
    meaning = base_unit(text)
    assert meaning.exponents == exponents
    assert meaning.factor == pytest.approx(factor, rel=1e-15)
    assert meaning.offset == offset
    assert isinstance(meaning, BaseUnit)
