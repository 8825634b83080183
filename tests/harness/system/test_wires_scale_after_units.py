"""target = factor * unit(source) + offset, rounded once."""

from fractions import Fraction

import pytest

from harness.errors import GraphError
from harness.system.check import check
from harness.system.graph import Connection
from harness.system.lowering import lower
from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.small_systems import end, fmu, system


@pytest.mark.parametrize("convert", [True, False])
def test_factor_and_offset(convert: bool) -> None:
    fmus = {
        "a": MockFmu((), (Output("y", unit="degC"),)).description,
        "b": MockFmu((Input("u", unit="K"),), ()).description,
    }
    one = Connection(end("a.y"), end("b.u"), factor=0.1, offset=0.3, convert_units=convert)
    loop = system(fmu("a"), fmu("b"), one)
    check(loop, fmus)
    (wire,) = lower(loop, fmus).wires
    offset = Fraction(0.1) * (Fraction(273.15) if convert else 0) + Fraction(0.3)
    assert (wire.factor, wire.offset) == (0.1, float(offset))


def test_units_that_differ_are_no_fault_where_none_is_converted() -> None:
    fmus = {
        "a": MockFmu((), (Output("y", unit="m"),)).description,
        "b": MockFmu((Input("u", unit="K"),), ()).description,
    }
    check(system(fmu("a"), fmu("b"), Connection(end("a.y"), end("b.u"), convert_units=False)), fmus)
    infinite = Connection(end("a.y"), end("b.u"), factor=float("inf"), convert_units=False)
    with pytest.raises(GraphError, match=r"factor inf and offset 0\.0 must be finite"):
        check(system(fmu("a"), fmu("b"), infinite), fmus)
