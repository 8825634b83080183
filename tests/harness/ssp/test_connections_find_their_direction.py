"""Kinds decide what is a source; dictionaries carry signals; impossible wirings are refused."""

from pathlib import Path

import pytest

from harness.errors import ExperimentError
from tests.harness.ssp.packages import WAY_OUT, Read, component, connector, folder, ssd, wire

Y, U = connector("y", "output"), connector("u", "input")


def read(path: Path, elements: str, *connections: str, more: str = "") -> Read:
    inner = (
        f"<ssd:Elements>{elements}</ssd:Elements>"
        f"<ssd:Connections>{''.join(connections)}</ssd:Connections>{more}"
    )
    return Read(folder(path, {"SystemStructure.ssd": ssd(inner)}))


def test_start_and_end_may_be_either(tmp_path: Path) -> None:
    two = component("a", Y) + component("b", U)
    assert read(tmp_path / "1", two, wire("a.y", "b.u")).paths() == {"b.u": "a.y"}
    assert read(tmp_path / "2", two, wire("b.u", "a.y")).paths() == {"b.u": "a.y"}


def test_systems_in_systems_rename_what_passes(tmp_path: Path) -> None:
    inner = (
        f"<ssd:System name='I'><ssd:Connectors>{connector('deep', 'output')}</ssd:Connectors>"
        f"<ssd:Elements>{component('a', Y)}</ssd:Elements>"
        f"<ssd:Connections>{wire('deep', 'a.y')}</ssd:Connections></ssd:System>"
    )
    outer = (
        f"<ssd:System name='O'><ssd:Connectors>{connector('out', 'output')}</ssd:Connectors>"
        f"<ssd:Elements>{inner}</ssd:Elements>"
        f"<ssd:Connections>{wire('I.deep', 'out')}</ssd:Connections></ssd:System>"
    )
    found = read(tmp_path, outer + component("b", U), wire("O.out", "b.u"))
    assert found.paths() == {"b.u": "O.I.a.y"}


def test_a_dictionary_of_an_outer_system_carries_a_signal(tmp_path: Path) -> None:
    reference = (
        "<ssd:SignalDictionaryReference name='bus' dictionary='D'><ssd:Connectors>"
        + connector("speed", "inout")
        + "</ssd:Connectors></ssd:SignalDictionaryReference>"
    )
    inner = (
        f"<ssd:System name='S'><ssd:Elements>{component('a', Y)}{reference}</ssd:Elements>"
        f"<ssd:Connections>{wire('a.y', 'bus.speed')}</ssd:Connections></ssd:System>"
    )
    dictionary = (
        "<ssd:SignalDictionaries><ssd:SignalDictionary name='D'>"
        "<ssb:SignalDictionary version='1.0'><ssb:DictionaryEntry name='speed'>"
        "<ssc:Real/></ssb:DictionaryEntry>"
        "</ssb:SignalDictionary></ssd:SignalDictionary></ssd:SignalDictionaries>"
    )
    elements = inner + component("b", U) + reference
    found = read(tmp_path, elements, wire("bus.speed", "b.u"), more=dictionary)
    assert found.paths() == {"b.u": "S.a.y"}


def test_another_description_takes_the_place_of_a_component(tmp_path: Path) -> None:
    part = ssd(
        f"<ssd:Connectors>{connector('out', 'output')}</ssd:Connectors>"
        f"<ssd:Elements>{component('a', Y, source='../a.fmu')}</ssd:Elements>"
        f"<ssd:Connections>{wire('a.y', 'out')}</ssd:Connections>"
    )
    other = "<ssd:Component name='P' type='application/x-ssp-definition' source='parts/p.ssd'/>"
    whole = ssd(
        f"<ssd:Elements>{other}{component('b', U)}</ssd:Elements>"
        f"<ssd:Connections>{wire('P.out', 'b.u')}</ssd:Connections>"
    )
    found = Read(folder(tmp_path, {"SystemStructure.ssd": whole, "parts/p.ssd": part}))
    assert found.paths() == {"b.u": "P.a.y"}


@pytest.mark.parametrize(
    ("connections", "words"),
    [
        ((wire("a.y", "b.u"), wire("c.y", "b.u")), r"b\.u is fed twice, from a\.y and c\.y"),
        ((wire("a.y", "c.y"),), r"a\.y – c\.y: both connectors give values"),
        ((wire("b.u", "b.v"),), "both connectors take values"),
        ((wire("a.y", "b.w"),), r"has no variable 'w'; legal names: b, f"),
        ((wire("a.y", "d.u"),), r"there is no element 'd'; legal names: a, b, c"),
        ((wire("a.y", "b.u", more='startIndices="1"'),), "single elements of arrays"),
        ((wire("p", "b.u"),), r"there is no connector p"),
    ],
)
def test_faults_name_both_ends(tmp_path: Path, connections: tuple[str, ...], words: str) -> None:
    three = component("a", Y) + component("b", U) + component("c", Y)
    with pytest.raises(ExperimentError, match=words) as caught:
        read(tmp_path, three, *connections)
    assert WAY_OUT.search(str(caught.value))
