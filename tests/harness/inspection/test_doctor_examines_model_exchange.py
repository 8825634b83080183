"""The doctor finds an honest FMU in model exchange healthy, and names the promise that a liar
breaks, in this process or in the next."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.inspection.doctor import Diagnosis, examine
from harness.inspection.finding import Verdict
from tests.harness.inspection.liars import exchange_liar

CASES = {
    "SLOPE": ("derivatives", "providesDirectionalDerivatives"),
    "RATES": ("repeats a run", None),
    "ROUND_TRIP": ("returns its states", "set and get of the continuous states"),
    "SNAPSHOT": ("restores a snapshot", "canGetAndSetFMUState"),
    "BYTES": ("serialises its state", "canSerializeFMUState"),
    "PROCESS": ("continues in a new process", "canSerializeFMUState"),
    "INDICATOR": ("event indicators", "event indicators"),
    "NOMINAL": ("nominal values", "nominals of the continuous states"),
    "FEEDTHROUGH": ("feedthrough as declared", "dependencies of y"),
    "LEAK": ("survives 200 instances", None),
}
"""The check that fails, and the lie that it names."""


def failures(found: Diagnosis) -> set[str]:
    return {f.check for f in found.findings if f.verdict is Verdict.FAILED}


def test_an_honest_fmu_is_healthy_and_may_do_all_but_resume(tmp_path: Path) -> None:
    found = examine(exchange_liar(tmp_path))
    assert found.healthy and found.lies == ()
    assert {f.verdict for f in found.findings} == {Verdict.PASSED}
    assert {f.interface_type for f in found.findings} == {"model-exchange"}
    refused = {a.use: a.reason for a in found.allowances if not a.allowed}
    assert refused == {"resume": "the solver cannot be stored"}
    assert found.allowances[0].use == "simulate, model exchange"


@pytest.mark.parametrize("fault", CASES)
def test_a_liar_is_named(tmp_path: Path, fault: str) -> None:
    check, lie = CASES[fault]
    found = examine(exchange_liar(tmp_path, fault))
    assert check in failures(found)
    assert lie is None or lie in found.lies


def test_only_the_other_process_sees_an_address(tmp_path: Path) -> None:
    assert failures(examine(exchange_liar(tmp_path, "PROCESS"))) == {"continues in a new process"}


def test_a_refused_state_is_no_reason_to_refuse_the_run(tmp_path: Path) -> None:
    """`simulate` needs no snapshot; it needs states that are what the solver made them."""
    allowed = {}
    for fault in ("SNAPSHOT", "ROUND_TRIP"):
        folder = tmp_path / fault
        folder.mkdir()
        found = examine(exchange_liar(folder, fault))
        allowed[fault] = found.allowances[0].allowed
    assert allowed == {"SNAPSHOT": True, "ROUND_TRIP": False}
