"""An FMU gives the same rows, whichever way it is run: to the bit in co-simulation and scheduled
execution, to the tolerance of the solver in model exchange."""

import pytest

from tests.every_way.agreement import differences, pairs
from tests.every_way.cases import CASES, Case
from tests.every_way.models import needs_compiler

pytestmark = needs_compiler


@pytest.mark.parametrize(("case", "way"), list(pairs(CASES.values())))
def test_the_rows_are_those_of_the_plain_driver(case: Case, way: str) -> None:
    assert differences(case, way) == []
