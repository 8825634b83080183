"""FMI 3 arrays: wired whole or element by element, handed over in one call, recorded by element."""

from dataclasses import replace

import numpy as np
import pytest

from harness.errors import GraphError
from harness.master.run import plan_system
from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, controller, fmu, system, wire

H = 0.01


def source(kind: str = "Float64", size: int = 3) -> MockFmu:
    """y[i] = i * state."""
    return MockFmu((Input("v", "Float64"),), (Output("y", kind, size=size),), fmi_major=3)


def sink(kind: str = "Float64", size: int = 3) -> MockFmu:
    inputs = (Input("first", "Float64"), Input("u", kind, size=size))
    outputs = (Output("y", "Float64"), Output("sum", "Float64", 0.0, depends=("u",)))
    return MockFmu(inputs, outputs, fmi_major=3)


@pytest.mark.parametrize("kind", ["Float64", "Int32", "Float32"])
def test_a_whole_array_is_one_wire_an_element(kind: str) -> None:
    fmus = {"a": source(kind), "b": sink(kind)}
    rows = run(system(fmu("a"), fmu("b"), wire("a.y", "b.u")), fmus)
    y = np.column_stack([rows[f"a.y[{i}]"] for i in (1, 2, 3)])
    u = np.column_stack([rows[f"b.u[{i}]"] for i in (1, 2, 3)])
    assert np.array_equal(u, y)
    assert np.array_equal(rows["b.sum"], y @ [2 / 8, 3 / 8, 4 / 8]), "read after what it needs"
    calls = fmus["b"].instances[0].calls
    assert calls.count(f"Set{kind}") <= 2 * 11 + 2, "an array is set in one call"


def test_elements_that_nothing_is_wired_to_keep_their_start_values() -> None:
    fmus = {"a": source(), "b": sink()}
    d = fmus["b"].description
    fmus["b"].description = replace(
        d, variables={**d.variables, "u": replace(d.variables["u"], start="5 6 7")}
    )
    whole = system(
        fmu("a"), fmu("b"), controller(lambda time: 2.5), wire("a.y[2]", "b.u[1]"),
        wire("controller.u", "b.u[3]"), stop_ns=20 * MS,
    )  # fmt: skip
    run(whole, fmus)
    model = fmus["b"].instances[0].model
    state = fmus["a"].instances[0].model.state
    assert [model.values[f"u[{i}]"] for i in (1, 2, 3)] == [2 * state, 6.0, 2.5]
    columns = run(whole, fmus, ("b.u",)).columns
    assert columns == ("b.u[1]", "b.u[3]"), "by the name of the array, what is wired of it"


def test_what_is_on_the_wire_is_on_every_element() -> None:
    fmus = {"a": source(), "b": sink()}
    rows = run(system(fmu("a"), fmu("b"), wire("a.y", "b.u", 20 * MS)), fmus)
    for i in (1, 2, 3):
        assert np.array_equal(rows[f"b.u[{i}]"][2:], rows[f"a.y[{i}]"][:-2])


def test_an_algebraic_loop_of_arrays_is_seen_by_element() -> None:
    ports = (Input("u", "Float64", size=2),), (Output("y", "Float64", depends=("u",), size=2),)
    through = MockFmu(*ports, fmi_major=3)
    loop = system(fmu("a"), wire("a.y", "a.u"))
    with pytest.raises(GraphError, match=r"algebraic loop .*a\.u\[1\]"):
        plan_system(replace(loop, algebraic_loops="refuse"), {"a": through})  # type: ignore[dict-item]
    rows = run(replace(loop, algebraic_loops="solve"), {"a": through})
    y1, y2 = rows["a.y[1]"], rows["a.y[2]"]
    assert np.allclose(y2 - y1, (y1 - y1 / 8 - y2 / 4), rtol=1e-9), "y[i] = i s + y[1]/8 + y[2]/4"


@pytest.mark.parametrize(
    ("made", "sentence"),
    [
        (wire("a.y", "b.first"), r"Float64\[3\] to Float64: arrays are wired whole"),
        (wire("a.y[4]", "b.first"), r"a has no output 'y\[4\]'; did you mean 'y\[3\]'"),
        (wire("c.y", "b.u"), r"Float64\[2\] to Float64\[3\]"),
    ],
)
def test_what_does_not_fit_is_named(made: object, sentence: str) -> None:
    fmus = {"a": source(), "b": sink(), "c": source(size=2)}
    with pytest.raises(GraphError, match=sentence):
        plan_system(system(*map(fmu, fmus), made), fmus)  # type: ignore[arg-type]


def test_one_element_of_what_is_reached() -> None:
    """Gauss–Seidel reads the whole array at the end of the step, though one element is wired."""
    fmus = {"a": source(), "b": sink()}
    rows = run(
        system(fmu("a"), fmu("b"), wire("a.y[3]", "b.first"), algorithm="gauss-seidel"), fmus
    )
    t = np.arange(10) * H / 64
    expected = 0.9 * rows["b.y"][:-1] + H * rows["a.y[3]"][1:] + t
    assert np.array_equal(rows["b.y"][1:], expected)
