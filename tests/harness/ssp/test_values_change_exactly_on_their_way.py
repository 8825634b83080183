"""Units first, then transformations, over any number of connectors, rounded once."""

from fractions import Fraction
from pathlib import Path

import pytest

from harness.errors import ExperimentError
from harness.ssp.change import as_float
from harness.ssp.flatten import change_along
from tests.harness.ssp.packages import UNITS, Read, component, connector, folder, ssd, wire

ENUMERATIONS = """<ssd:Enumerations>
  <ssc:Enumeration name="gear"><ssc:Item name="low" value="1"/><ssc:Item name="high" value="2"/>
  </ssc:Enumeration>
  <ssc:Enumeration name="lever"><ssc:Item name="slow" value="10"/><ssc:Item name="fast" value="30"/>
  </ssc:Enumeration></ssd:Enumerations>"""


def real(unit: str = "") -> str:
    return f'<ssc:Real unit="{unit}"/>' if unit else "<ssc:Real/>"


def numbers(path: Path, inner: str) -> tuple[float, float]:
    read = Read(folder(path, {"SystemStructure.ssd": ssd(inner, ENUMERATIONS + UNITS)}))
    (one,) = [wire for wire in read.wires if wire.driven]
    source = read.ports.port(one.source)
    change = change_along(one.edges, read.ports, source.unit)
    return as_float(change.factor), as_float(change.offset)


def pair(source: str, target: str, connection: str) -> str:
    return (
        "<ssd:Elements>"
        + component("a", connector("y", "output", source))
        + component("b", connector("u", "input", target))
        + f"</ssd:Elements><ssd:Connections>{connection}</ssd:Connections>"
    )


LINEAR = '<ssc:LinearTransformation factor="3" offset="0.5"/>'


@pytest.mark.parametrize(
    ("source", "target", "inner", "more", "expected"),
    [
        ("m", "mm", "", "", (1 / Fraction(0.001), 0)),
        ("m", "mm", LINEAR, "", (3 / Fraction(0.001), Fraction(1, 2))),
        ("m", "mm", LINEAR, 'suppressUnitConversion="true"', (3, Fraction(1, 2))),
        ("m", "mm", "", 'suppressUnitConversion="true"', (1, 0)),
        ("m", "", LINEAR, "", (3, Fraction(1, 2))),
        (
            "K", "degF", LINEAR, "",
            (3 / Fraction(0.5555555555555556),
             -3 * Fraction(255.3722222222222) / Fraction(0.5555555555555556) + Fraction(1, 2)),
        ),
    ],
)  # fmt: skip
def test_units_first_then_the_transformation(
    tmp_path: Path, source: str, target: str, inner: str, more: str, expected: tuple[Fraction, ...]
) -> None:
    found = numbers(tmp_path, pair(real(source), real(target), wire("a.y", "b.u", inner, more)))
    assert found == tuple(map(float, expected))


def test_connectors_renamed_at_boundaries_leave_no_trace_of_rounding(tmp_path: Path) -> None:
    tenth = '<ssc:LinearTransformation factor="0.1" offset="0.1"/>'
    inner = (
        f"<ssd:System name='S'><ssd:Connectors>{connector('in', 'input', real('mm'))}"
        "</ssd:Connectors>"
        f"<ssd:Elements>{component('b', connector('u', 'input', real('m')))}</ssd:Elements>"
        f"<ssd:Connections>{wire('in', 'b.u', tenth)}</ssd:Connections></ssd:System>"
    )
    whole = (
        f"<ssd:Elements>{component('a', connector('y', 'output', real('m')))}{inner}</ssd:Elements>"
        f"<ssd:Connections>{wire('a.y', 'S.in', tenth)}</ssd:Connections>"
    )
    f, milli = Fraction(0.1), Fraction(0.001)
    expected = (f / milli * milli * f, f * milli * f + f)
    assert numbers(tmp_path, whole) == tuple(map(float, expected))


def mapping(kind: str, *pairs: tuple[str, str]) -> str:
    entries = "".join(f'<ssc:MapEntry source="{s}" target="{t}"/>' for s, t in pairs)
    return f"<ssc:{kind}MappingTransformation>{entries}</ssc:{kind}MappingTransformation>"


@pytest.mark.parametrize(
    ("source", "target", "inner", "values"),
    [
        ("i", "n", mapping("Integer", ("1", "7"), ("2", "1")), {1: 7, 2: 1, 3: 3}),
        ("f", "b", mapping("Boolean", ("true", "false"), ("false", "true")), {0: 1, 1: 0}),
        ("f", "b", mapping("Boolean", ("1", "0")), {0: 0, 1: 0}),
        ("i", "n", mapping("Enumeration", ("low", "slow"), ("high", "fast")), {1: 10, 2: 30}),
    ],
)
def test_tables_of_values(
    tmp_path: Path, source: str, target: str, inner: str, values: dict[int, int]
) -> None:
    kinds = {"i": '<ssc:Enumeration name="gear"/>', "n": '<ssc:Enumeration name="lever"/>'}
    a = component("a", connector(source, "output", kinds.get(source, "<ssc:Boolean/>")))
    b = component("b", connector(target, "input", kinds.get(target, "<ssc:Boolean/>")))
    connection = wire(f"a.{source}", f"b.{target}", inner)
    whole = f"<ssd:Elements>{a}{b}</ssd:Elements><ssd:Connections>{connection}</ssd:Connections>"
    read = Read(folder(tmp_path, {"SystemStructure.ssd": ssd(whole, ENUMERATIONS + UNITS)}))
    change = change_along(read.wires[0].edges, read.ports, None)
    assert {key: change.of(key) for key in values} == values
    assert not (source == "f" and change.table), "a boolean needs no table"


def test_units_that_cannot_be_converted_name_the_connection(tmp_path: Path) -> None:
    inner = pair(real("m"), real("K"), wire("a.y", "b.u"))
    with pytest.raises(ExperimentError, match=r"connection a\.y – b\.u: unit 'm' .*cannot be"):
        numbers(tmp_path, inner)
