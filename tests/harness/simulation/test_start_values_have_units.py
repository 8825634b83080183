"""Start values: units, display units, differences, texts, elements, and what cannot be set."""

from pathlib import Path

import pytest

from harness import simulate
from harness.errors import HarnessError
from harness.fmi.fmu import Fmu
from harness.fmi.start_values import parse_assignment
from tests.harness.fmi.archives import member, rewritten
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler


def first(assignment: str, name: str, kind: str = "2", path: Path | None = None) -> float:
    fmu = path or model_fmu(kind)
    with Fmu(fmu) as opened:
        key, value = parse_assignment(opened.description, assignment)
    result = simulate(fmu, stop_time=0.0, start_values={key: value}, output_variables=[name])
    return float(result[name][0])


@pytest.mark.parametrize("kind", ["2", "3"])
@pytest.mark.parametrize(
    ("assignment", "name", "value"),
    [
        ("h=2", "h", 2.0), ("h = 2 [m]", "h", 2.0), ("h=10[ft]", "h", 3.048),
        ("h=150[cm]", "h", 1.5), ("x=20[degC]", "x", 293.15), ("x=300[K]", "x", 300.0),
        ("k=2.5e-1", "k", 0.25),
    ],
)  # fmt: skip
def test_units_are_converted(kind: str, assignment: str, name: str, value: float) -> None:
    assert first(assignment, name, kind) == pytest.approx(value, rel=1e-12)


def test_a_difference_is_converted_without_offset(tmp_path: Path) -> None:
    source = model_fmu("2")
    xml = member(source, "modelDescription.xml")
    relative = xml.replace(b'start="1" unit="K"', b'start="1" unit="K" relativeQuantity="true"')
    assert relative != xml
    made = rewritten(source, tmp_path / "a.fmu", modelDescription_dot_xml=relative)
    assert first("x=20[degC]", "x", path=made) == 20.0


@pytest.mark.parametrize(
    ("assignment", "words"),
    [
        ("h", "must have the form name=value"),
        ("hh=1", "component test: no variable 'hh' to give a start value"),
        ("h=high", "'h' must be a number .Real., not 'high'"),
        ("h=1[s]", "start value of 'h' cannot be in 's': unit 's' .* cannot be converted to 'm'"),
        ("k=1[m]", "'k' has no unit, but 'm' was given"),
        ("i_in=1[m]", "of type Integer has no unit"),
        ("counter=1", "'counter' cannot be set, for the FMU calculates it .output."),
        ("der(x)=1", "'der.x.' cannot be set"),
        ("b_in=maybe", "'b_in' must be true or false, not 'maybe'"),
        ("h[1]=2", "'h.1.' is for no element of 'h', whose sizes are those of a scalar"),
    ],
)
def test_what_cannot_be_meant_is_said(assignment: str, words: str) -> None:
    with pytest.raises(HarnessError, match=words):
        first(assignment, "h")


@pytest.mark.parametrize(
    ("starts", "words"),
    [
        ({"w[4]": 1.0}, "'w.4.' is for no element of 'w', whose sizes are 3"),
        ({"w": [1.0, 2.0]}, r"'w' must have 3 element\(s\), not 2"),
        ({"n": 99}, "fmi3SetUInt64 of variable 'n' returned Error"),
    ],
)
def test_arrays_that_do_not_fit(starts: dict[str, object], words: str) -> None:
    with pytest.raises(HarnessError, match=words):
        simulate(model_fmu("3"), start_values=starts)
