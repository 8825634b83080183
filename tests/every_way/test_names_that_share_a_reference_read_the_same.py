"""Whatever a description holds, what is recorded of an FMU is what the plain driver reads: value
references that variables share, types, sizes, orders."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.every_way.agreement import differences
from tests.every_way.drawn import cases
from tests.every_way.models import needs_compiler

pytestmark = needs_compiler


@pytest.mark.parametrize("version", [1, 2, 3])
@pytest.mark.parametrize("way", ["simulate", "bench", "wires"])
@settings(max_examples=40)
@given(data=st.data())
def test_the_rows_are_those_of_the_plain_driver(
    way: str, version: int, data: st.DataObject
) -> None:
    assert differences(data.draw(cases(version)), way) == []
