"""The Reference FMUs give the same rows, whichever way they are run; where
FMU_HARNESS_REFERENCE_FMUS names their folders (separated as PATH is)."""

import os
from pathlib import Path

import pytest

from tests.every_way.agreement import differences, pairs
from tests.every_way.cases import Case
from tests.every_way.reference_fmus import reference_cases

FOLDERS = [Path(p) for p in os.environ.get("FMU_HARNESS_REFERENCE_FMUS", "").split(os.pathsep) if p]
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not FOLDERS, reason="FMU_HARNESS_REFERENCE_FMUS names no folder"),
]


@pytest.mark.parametrize(("case", "way"), list(pairs(reference_cases(FOLDERS))))
def test_the_rows_are_those_of_the_plain_driver(case: Case, way: str) -> None:
    assert differences(case, way) == []
