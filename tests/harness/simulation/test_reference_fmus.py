"""The Reference FMUs, where FMU_HARNESS_REFERENCE_FMUS names their folders (separated as PATH is):
built in any versions, together with their published outputs and inputs."""

import os
from pathlib import Path

import pytest

from benchmarks.reference_fmus import Row, run_all

FOLDERS = os.environ.get("FMU_HARNESS_REFERENCE_FMUS", "")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not FOLDERS, reason="FMU_HARNESS_REFERENCE_FMUS names no folder"),
]


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    return list(run_all([Path(folder) for folder in FOLDERS.split(os.pathsep)]))


def test_all_of_them_agree(rows: list[Row]) -> None:
    assert rows
    assert [row for row in rows if not row.agrees] == []


def test_co_simulation_is_equal_to_the_published_output(
    rows: list[Row],
) -> None:
    stepped = [r for r in rows if r.kind == "co-simulation" and r.difference is not None]
    assert stepped and max(r.difference for r in stepped if r.difference is not None) < 1e-15


def test_scheduled_execution_follows_the_schedule_of_the_description(rows: list[Row]) -> None:
    scheduled = [r for r in rows if r.kind == "scheduled-execution" and r.difference is not None]
    assert all(row.difference == 0.0 for row in scheduled)
