"""What a package cannot mean is refused in a sentence that says what to change."""

from pathlib import Path

import pytest

from harness.errors import ExperimentError
from tests.harness.ssp.packages import (
    NAMESPACES,
    WAY_OUT,
    Read,
    component,
    connector,
    folder,
    ssd,
    wire,
)

TWICE = (
    "<ssc:IntegerMappingTransformation><ssc:MapEntry source='1' target='2'/>"
    "<ssc:MapEntry source='1' target='3'/></ssc:IntegerMappingTransformation>"
)
NO_NUMBER = TWICE.replace("source='1'", "source='x'")
ITEMS = TWICE.replace("Integer", "Enumeration")
LINEAR = '<ssc:LinearTransformation factor="{}"/>'


def refused(path: Path, inner: str, words: str) -> None:
    with pytest.raises(ExperimentError, match=words) as caught:
        Read(folder(path, {"SystemStructure.ssd": ssd(inner)}))
    text = str(caught.value)
    assert "SystemStructure.ssd" in text and WAY_OUT.search(text) and text.isprintable(), text


@pytest.mark.parametrize(
    ("transformation", "words"),
    [
        (LINEAR.format("much"), "factor='much' is no number; write one"),
        (TWICE, "the source '1' is mapped twice; leave one entry out"),
        (NO_NUMBER, "the source 'x' is no whole number; write one"),
        (ITEMS, "names no enumeration of the document; give its type one"),
        (LINEAR.format("INF"), "are not finite; give finite ones"),
    ],
)
def test_transformations(tmp_path: Path, transformation: str, words: str) -> None:
    binding = set_of("<ssv:Parameter name='x'><ssv:Real value='1'/></ssv:Parameter>")
    inner = (
        f"<ssd:Connectors>{connector('x', 'input')}</ssd:Connectors>{binding}<ssd:Elements>"
        f"{component('b', connector('u', 'input'))}</ssd:Elements>"
        f"<ssd:Connections>{wire('x', 'b.u', transformation)}</ssd:Connections>"
    )
    refused(tmp_path, inner, words)


def set_of(parameters: str) -> str:
    return (
        "<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>"
        f"<ssv:ParameterSet {NAMESPACES} version='1.0' name='p'><ssv:Parameters>{parameters}"
        "</ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding>"
        "</ssd:ParameterBindings>"
    )


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("<ssv:Real value='high'/>", "u: the Real 'high' is no number; write one"),
        ("<ssv:Integer value='1.5'/>", "u: the Integer '1.5' is no whole number; write one"),
        ("<ssv:Boolean value='on'/>", "u: the Boolean 'on' is neither true nor false; write one"),
        ("<ssv:Real value=''/>", "u has no value; give it one"),
        ("<ssv:Binary value='00'/>", "u: binary parameters cannot be set; leave it out"),
    ],
)
def test_parameters(tmp_path: Path, value: str, words: str) -> None:
    binding = set_of(f"<ssv:Parameter name='u'>{value}</ssv:Parameter>")
    refused(tmp_path, f"<ssd:Elements>{component('b', more=binding)}</ssd:Elements>", words)


@pytest.mark.parametrize(
    ("element", "words"),
    [
        ("<ssd:Component name='c' source='#other'/>", "no system has the id 'other'; give it"),
        ("<ssd:Component name='c' source='a.fmu' type='text/plain'/>", "'text/plain'; give an FMU"),
        ("<ssd:Component name='c' source=''/>", "names no file; give one"),
        ("<ssd:System name='c'/><ssd:System name='c'/>", "name 'c' is used twice; give each"),
        ("<ssd:System name=''/>", "the element name '' is empty; give each"),
        ("<ssd:SignalDictionaryReference name='r' dictionary='bus'/>"
         + component("b", connector("u", "input")), "there is no dictionary 'bus'"),
        (component("b", more="<ssd:ParameterBindings><ssd:ParameterBinding type='text/csv' "
                   "source='p.csv'/></ssd:ParameterBindings>"), "'text/csv' cannot be read; give"),
        (component("b", more="<ssd:ParameterBindings><ssd:ParameterBinding source='p.ssv' "
                   "sourceBase='component'/></ssd:ParameterBindings>"), "readable 'p.ssv'; pack"),
    ],
)  # fmt: skip
def test_elements(tmp_path: Path, element: str, words: str) -> None:
    connections = wire("r.x", "b.u") if "Dictionary" in element else ""
    inner = f"<ssd:Elements>{element}</ssd:Elements>"
    if connections:
        inner += f"<ssd:Connections>{connections}</ssd:Connections>"
    refused(tmp_path, inner, words)
