"""Parameter sets, prefixes and mappings; higher levels win; connectors pass values on."""

import warnings
from pathlib import Path

import pytest

from tests.harness.ssp.packages import (
    NAMESPACES,
    UNITS,
    Read,
    component,
    connector,
    folder,
    ssd,
    wire,
)

REAL_MM, REAL_M = '<ssc:Real unit="mm"/>', '<ssc:Real unit="m"/>'


def values(*pairs: tuple[str, str]) -> str:
    inner = "".join(f'<ssv:Parameter name="{n}">{v}</ssv:Parameter>' for n, v in pairs)
    units = UNITS.replace("ssd:", "ssv:")
    return (
        f'<ssv:ParameterSet {NAMESPACES} version="1.0" name="p"><ssv:Parameters>{inner}'
        f"</ssv:Parameters>{units}</ssv:ParameterSet>"
    )


def binding(content: str, mapping: str = "", attributes: str = "") -> str:
    return (
        f"<ssd:ParameterBinding {attributes}><ssd:ParameterValues>{content}</ssd:ParameterValues>"
        f"{mapping}</ssd:ParameterBinding>"
    )


def bindings(*inner: str) -> str:
    return f"<ssd:ParameterBindings>{''.join(inner)}</ssd:ParameterBindings>"


def real(value: float, unit: str = "") -> str:
    return f'<ssv:Real value="{value}"' + (f' unit="{unit}"/>' if unit else "/>")


def starts(path: Path, inner: str, **files: str) -> dict[str, dict[str, object]]:
    named = {name.replace("_dot_", "."): text for name, text in files.items()}
    return Read(folder(path, {"SystemStructure.ssd": ssd(inner, UNITS), **named})).starts


def nested(of_system: str, of_component: str) -> str:
    """root with S (input "x", renamed) with FMU b, whose u is fed by x."""
    return (
        "<ssd:Elements><ssd:System name='S'>"
        f"<ssd:Connectors>{connector('x', 'input', REAL_MM)}</ssd:Connectors>{of_system}"
        f"<ssd:Elements>{component('b', connector('u', 'input', REAL_M), of_component)}"
        "</ssd:Elements><ssd:Connections>"
        + wire("x", "b.u", '<ssc:LinearTransformation factor="2" offset="1"/>')
        + "</ssd:Connections></ssd:System></ssd:Elements>"
    )


def test_higher_levels_win_then_later_ones(tmp_path: Path) -> None:
    low = bindings(binding(values(("v", real(1)), ("z", real(5)))), binding(values(("z", real(6)))))
    high = bindings(binding(values(("b.v", real(2)))))
    root = bindings(binding(values(("S.b.v", real(3)))))
    assert starts(tmp_path / "1", nested("", low)) == {"S.b": {"v": 1.0, "z": 6.0}}
    assert starts(tmp_path / "2", nested(high, low))["S.b"]["v"] == 2.0
    assert starts(tmp_path / "3", root + nested(high, low))["S.b"]["v"] == 3.0


def test_a_connectors_value_goes_on_with_units_and_transformations(tmp_path: Path) -> None:
    given = bindings(binding(values(("S.x", real(0.25, "m")))))
    assert starts(tmp_path, given + nested("", "")) == {"S.b": {"u": 2 * 0.25 + 1}}


def test_a_connection_gives_the_value_whatever_else_is_bound(tmp_path: Path) -> None:
    given = bindings(binding(values(("S.x", real(0.25, "m")), ("S.b.u", real(7)))))
    with pytest.warns(UserWarning, match=r"S\.b\.u is not used: .*connection x – b\.u"):
        assert starts(tmp_path, given + nested("", "")) == {"S.b": {"u": 2 * 0.25 + 1}}


@pytest.mark.parametrize(
    ("attributes", "expected"),
    [("", 2 * 3000.0 + 1), ('suppressUnitConversion="true"', 2 * 3.0 + 1)],
)
@pytest.mark.parametrize("inline", [True, False])
def test_mappings_inline_and_by_source(
    tmp_path: Path, attributes: str, expected: float, inline: bool
) -> None:
    linear = '<ssc:LinearTransformation factor="2" offset="1"/>'
    entry = f'<ssm:MappingEntry source="far" target="mm" {attributes}>{linear}</ssm:MappingEntry>'
    document = f'<ssm:ParameterMapping {NAMESPACES} version="1.0">{entry}</ssm:ParameterMapping>'
    content = values(("far", real(3, "m")), ("v", real(9)))
    if inline:
        mapping = f"<ssd:ParameterMapping>{document}</ssd:ParameterMapping>"
        given = binding(content, mapping)
    else:
        mapping = '<ssd:ParameterMapping source="maps/m%201.ssm"/>'
        given = f'<ssd:ParameterBinding source="p.ssv">{mapping}</ssd:ParameterBinding>'
    files = {"p.ssv": content, "maps/m 1.ssm": document}
    inner = f"<ssd:Elements>{component('b', '', bindings(given))}</ssd:Elements>"
    whole = {"SystemStructure.ssd": ssd(inner, UNITS), **files}
    assert Read(folder(tmp_path, whole)).starts == {"b": {"mm": expected}}, "v is not mapped"


def test_prefixes_and_punning(tmp_path: Path) -> None:
    elements = component("B.C") + (
        f"<ssd:System name='B'><ssd:Elements>{component('C')}</ssd:Elements></ssd:System>"
    )
    given = bindings(binding(values(("v", real(4))), attributes='prefix="B.C."'))
    found = starts(tmp_path, f"{given}<ssd:Elements>{elements}</ssd:Elements>")
    assert found == {"B.C": {"v": 4.0}}
    read = Read(tmp_path)
    assert [node.path for node in read.tree.fmus] == [("B.C",), ("B", "C")]


def test_types_and_what_fits_nothing(tmp_path: Path) -> None:
    given = values(
        ("n", '<ssv:Integer value="3"/>'), ("b", '<ssv:Boolean value="1"/>'),
        ("u", '<ssv:Integer value="2"/>'), ("w", real(1)),
    )  # fmt: skip
    inner = f"<ssd:Elements>{component('b', '', bindings(binding(given)))}</ssd:Elements>"
    with pytest.warns(UserWarning, match="parameter binding of b: w fits no variable"):
        found = starts(tmp_path, inner)
    assert found == {"b": {"n": 3, "b": True, "u": 2.0}}
    assert [type(value) for value in found["b"].values()] == [int, bool, float]


def test_nothing_is_said_where_all_fits(tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        starts(tmp_path, nested("", ""))
