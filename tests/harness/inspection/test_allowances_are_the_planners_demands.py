"""What the doctor allows is what the planner accepts, for an FMU with and without each claim."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness import Bench, registry
from harness.errors import HarnessError
from harness.inspection.allowances import allowances
from harness.inspection.doctor import examine
from tests.harness.inspection.liars import liar

CLAIMS = {
    "iterative": 'canGetAndSetFMUstate="true"',
    "delays within a step": 'canHandleVariableCommunicationStepSize="true"',
}


def runs_in_the_loop(fmu: Path, use: str) -> bool:
    """Whether a bench that puts the FMU to this use can be run."""
    bench = Bench(
        stop_time=0.2, step=0.1, algorithm="iterative" if use == "iterative" else "jacobi"
    )
    for name in ("left", "right"):
        bench.fmu(name, fmu)
    delay = 0.03 if use == "delays within a step" else 0.0
    bench.connect("left.y", "right.u", delay=delay)
    bench.connect("right.y", "left.u")
    try:
        bench.run()
    except HarnessError:
        return False
    return True


@pytest.mark.parametrize("use", CLAIMS)
@pytest.mark.parametrize("claims", [True, False], ids=["claimed", "not claimed"])
def test_planner_and_doctor_agree(tmp_path: Path, use: str, claims: bool) -> None:
    fmu = liar(tmp_path, change=("", "") if claims else (CLAIMS[use], ""))
    allowed = {a.use: a.allowed for a in examine(fmu).allowances}
    assert allowed[use] is runs_in_the_loop(fmu, use) is claims


def test_a_plant_of_ours_is_allowed_everything_in_both_kinds() -> None:
    found = examine(registry.plant_fmu("two_mass_drive", 3))
    assert found.healthy
    assert {f.interface_type for f in found.findings} == {"co-simulation", "model-exchange"}
    assert [a.use for a in found.allowances if not a.allowed] == []
    known = tuple(f for f in found.findings if f.check != "continues in a new process")
    assert [a.use for a in allowances(found.description, known) if not a.allowed] == ["resume"]


def test_what_was_not_examined_is_not_allowed() -> None:
    found = examine(registry.plant_fmu("oscillator_left", 2))
    none = tuple(f for f in found.findings if f.check == "runs")
    refused = {a.use for a in allowances(found.description, none) if not a.allowed}
    assert {"iterative", "resume", "sensitivity", "delays within a step"} <= refused
