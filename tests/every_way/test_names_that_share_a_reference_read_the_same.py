"""Whatever a description holds, what is recorded of an FMU is what the plain driver reads: value
references that variables share, types, sizes, orders."""

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.every_way.agreement import differences
from tests.every_way.drawn import cases
from tests.every_way.models import needs_compiler
from tests.every_way.not_yet import reason

pytestmark = needs_compiler
NEGATED = "negated booleans"


def parameters() -> list[Any]:
    found = []
    for way in ("simulate", "bench", "wires"):
        for version in (1, 2, 3):
            why = reason(way, frozenset({f"FMI {version}", "shared"}))
            marks = [pytest.mark.xfail(reason=why, strict=True)] if why else []
            found.append(pytest.param(way, version, marks=marks))
    return found


@pytest.mark.parametrize(("way", "version"), parameters())
@settings(max_examples=40)
@given(data=st.data())
def test_the_rows_are_those_of_the_plain_driver(
    way: str, version: int, data: st.DataObject
) -> None:
    texts, negated = (reason(way, frozenset({need})) is None for need in ("text inputs", NEGATED))
    case = data.draw(cases(version, texts, negated))
    assert differences(case, way) == []
