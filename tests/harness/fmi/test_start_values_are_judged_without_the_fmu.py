"""What a start value means follows from the model description; all faults are told at once."""

import math
from typing import Any

import numpy as np
import pytest

from harness.errors import UsageError
from harness.fmi.description.model_description import ModelDescription
from harness.fmi.fmu import Fmu
from harness.fmi.start_values import judge_start_values
from tests.harness.fmi.archives import member, rewritten
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler
MATRIX = b'<Float64 name="A" valueReference="90" causality="parameter" start="1 2 3 4 5 6">' \
         b'<Dimension valueReference="20"/><Dimension start="2"/></Float64>'  # fmt: skip


@pytest.fixture(scope="module")
def d(tmp_path_factory: pytest.TempPathFactory) -> ModelDescription:
    source = model_fmu("3")
    xml = member(source, "modelDescription.xml")
    made = xml.replace(b"</ModelVariables>", MATRIX + b"</ModelVariables>")
    path = tmp_path_factory.mktemp("fmu") / "a.fmu"
    with Fmu(rewritten(source, path, modelDescription_dot_xml=made)) as fmu:
        return fmu.description


A = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"A[2,1]": 9}, {"A": [1.0, 2.0, 9.0, 4.0, 5.0, 6.0]}),
        ({"A": [[1, 2], [3, 4], [5, 6]], "A[3, 2]": "0"}, {"A": [*A[:5], 0.0]}),
        ({"A": np.arange(6.0).reshape(3, 2)}, {"A": [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]}),
        ({"n": "1", "A": "7,8"}, {"n": 1, "A": [7.0, 8.0]}),
        ({"n": np.uint64(2), "A[2,2]": 4.5}, {"n": 2, "A[2,2]": 4.5}),
        ({"x": np.float32(0.5)}, {"x": 0.5}),
        ({"h": [3, "ft"]}, {"h": pytest.approx(0.9144, rel=1e-15)}),
        ({"h": "1e2 [cm]"}, {"h": 1.0}),
        ({"UInt64_in": 2**64 - 1}, {"UInt64_in": 2**64 - 1}),
        ({"Int64_in": "9007199254740993"}, {"Int64_in": 2**53 + 1}),
        ({"Binary_in": "0aFF"}, {"Binary_in": b"\x0a\xff"}),
        ({"Binary_in": b"\x00"}, {"Binary_in": b"\x00"}),
        ({"String_in": "3 [ft]"}, {"String_in": "3 [ft]"}),
        ({"Boolean_in": 1.0}, {"Boolean_in": True}),
    ],
)
def test_values(d: ModelDescription, given: dict[str, Any], told: dict[str, Any]) -> None:
    found = judge_start_values(d, given, component="c").told
    assert found == told
    assert [type(one) for one in found.values()] == [
        type(getattr(one, "expected", one)) for one in told.values()
    ]


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"A[4,1]": 0.0}, "'A[4,1]' is for no element of 'A', whose sizes are 3 by 2"),
        ({"A[1]": 0.0}, "'A[1]' is for no element of 'A', whose sizes are 3 by 2"),
        ({"A": [[1, 2, 3], [4, 5, 6]]}, "'A' must have 3 by 2 element(s), not 2 by 3"),
        ({"A": "1 2"}, "'A' must have 3 by 2 element(s), not 2"),
        ({"h": (10**400, "ft")}, "'h' must be finite, not a number of 401 digits"),
        ({"h": (1e308, "km")}, "'h' must be finite, not inf"),
        ({"Float32_in": 1e39}, "'Float32_in' must fit Float32, not 1e+39"),
        ({"Int8_in": math.nan}, "'Int8_in' must be finite, not nan"),
        ({"UInt64_in": 10**5000}, "(UInt64), not a number of 5001 digits"),
        ({"Binary_in": 3}, "'Binary_in' must be bytes or hexadecimal text, not 3"),
        ({"Enumeration_in": "hihg"}, "must be one of 1 'low', 7 'high', not 'hihg'"),
        ({"n": -1}, "'n' must be between 0 and 18446744073709551615 (UInt64), not -1"),
    ],
)
def test_faults(d: ModelDescription, given: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UsageError) as caught:
        judge_start_values(d, given, component="c")
    assert str(caught.value).startswith("component c: start value of ")
    assert sentence in str(caught.value)


def test_every_fault_has_a_line(d: ModelDescription) -> None:
    with pytest.raises(UsageError) as caught:
        judge_start_values(d, {"h": "x", "k": 1.0, "kk": 2.0, "b": True}, component="c")
    lines = str(caught.value).splitlines()
    assert [line.split("'")[1] for line in lines] == ["h", "kk", "b"]


def test_sizes_that_no_memory_holds_are_refused(d: ModelDescription) -> None:
    with pytest.raises(UsageError, match=r"array 'w' would have \d+ elements .* at most 10000000"):
        judge_start_values(d, {"n": 2**40}, component="c")
