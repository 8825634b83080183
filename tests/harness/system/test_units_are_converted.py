"""value_in_target = factor * value + offset, from exponents, factors and offsets."""

import math

import pytest

from harness.errors import UnitError
from harness.system.units import Unit, conversion, parse_unit

TABLE = [
    ("m", "mm", 2.0, 2000.0), ("mm", "m", 5.0, 0.005), ("bar", "Pa", 1.5, 150_000.0),
    ("Pa", "MPa", 21e6, 21.0), ("kN", "N", 2.0, 2000.0), ("rev/min", "rad/s", 30.0, math.pi),
    ("deg", "rad", 180.0, math.pi), ("km/h", "m/s", 36.0, 10.0), ("cm3/s", "m3/s", 625.0, 625e-6),
    ("l/min", "m3/s", 60.0, 1e-3), ("degC", "K", 25.0, 298.15), ("K", "degC", 0.0, -273.15),
    ("N.m", "J", 3.0, 3.0), ("V.A", "W", 2.0, 2.0), ("%", "1", 50.0, 0.5),
    ("kg/m3", "g/l", 1.0, 1.0),
    ("m/s2", "m/s^2", 9.81, 9.81), ("1/s", "Hz", 4.0, 4.0), ("m3/(s.Pa)", "l/(s.bar)", 1e-8, 1.0),
]  # fmt: skip


@pytest.mark.parametrize(("source", "target", "value", "expected"), TABLE)
def test_table(source: str, target: str, value: float, expected: float) -> None:
    factor, offset = conversion(parse_unit(source), parse_unit(target))
    assert factor * value + offset == pytest.approx(expected, rel=1e-14, abs=1e-16)
    back = conversion(parse_unit(target), parse_unit(source))
    assert back[0] * expected + back[1] == pytest.approx(value, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(
    ("source", "target", "words"),
    [
        ("N", "m", "'N' (kg.m.s-2) cannot be converted to 'm' (m)"),
        ("rad/s", "Hz", "'rad/s' (s-1.rad) cannot be converted to 'Hz' (s-1)"),
        ("1", "K", "'1' (dimensionless) cannot be converted to 'K' (K)"),
        ("furlong", "m", "unit 'furlong' is not defined, so 'furlong' cannot be converted to 'm'"),
        ("m", "a/(b/c)", "unit 'a/(b/c)' is not defined"),
        ("N", "N/(m/s)", "unit 'N/(m/s)' is not defined"),
    ],
)
def test_what_cannot_be_converted_is_an_error(source: str, target: str, words: str) -> None:
    with pytest.raises(UnitError) as caught:
        conversion(parse_unit(source), parse_unit(target))
    assert words in str(caught.value)


@pytest.mark.parametrize("unit", ["m", "furlong", "", None])
def test_a_unit_that_is_not_stated_takes_that_of_its_neighbour(unit: str | None) -> None:
    stated = None if unit is None else parse_unit(unit)
    assert conversion(stated, None) == conversion(None, stated) == (1.0, 0.0)
    assert conversion(stated, stated) == (1.0, 0.0)


def test_the_fmus_own_definition_comes_first() -> None:
    odd = Unit("bar", (1, -1, -2, 0, 0, 0, 0, 0), 98_066.5)
    assert parse_unit("bar", {"bar": odd}) is odd
    assert conversion(parse_unit("bar", {"bar": odd}), parse_unit("Pa")) == (98_066.5, 0.0)
    undefined = Unit("bar")
    assert parse_unit("bar", {"bar": undefined}).factor == 1e5, "a bare name is looked up"


def test_fahrenheit_by_fmi_offset() -> None:
    fahrenheit = Unit("degF", (0, 0, 0, 0, 1, 0, 0, 0), 5 / 9, 273.15 - 32 * 5 / 9)
    there = conversion(fahrenheit, parse_unit("degC"))
    back = conversion(parse_unit("degC"), fahrenheit)
    for f, c in ((32.0, 0.0), (212.0, 100.0), (-40.0, -40.0)):
        assert there[0] * f + there[1] == pytest.approx(c, abs=1e-12)
        assert back[0] * c + back[1] == pytest.approx(f, abs=1e-12)
