"""The doctor finds an honest FMU healthy, and names the promise that a liar breaks."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.inspection.doctor import Diagnosis, examine
from harness.inspection.finding import Verdict
from tests.harness.inspection.liars import liar

CASES = {
    "SHARED": ("instantiates twice", "canBeInstantiatedOnlyOncePerProcess is false"),
    "DRIFTS": ("repeats a run", None),
    "PROCESS": ("repeats in a new process", None),
    "RESET": ("resets", None),
    "SNAPSHOT": ("restores a snapshot", "canGetAndSetFMUState"),
    "FEEDTHROUGH": ("feedthrough as declared", "dependencies of y"),
    "SLOPE": ("derivatives", "providesDirectionalDerivatives"),
    "STEPS": ("takes other steps", "canHandleVariableCommunicationStepSize"),
    "BLOWS_UP": ("runs", None),
    "LEAK": ("survives 200 instances", None),
    "DESCRIPTORS": ("survives 200 instances", None),
}


def verdicts(found: Diagnosis) -> dict[str, Verdict]:
    return {f.check: f.verdict for f in found.findings}


def test_an_honest_fmu_is_healthy(tmp_path: Path) -> None:
    found = examine(liar(tmp_path))
    assert found.healthy and found.lies == ()
    refused = {"serialises its state", "takes slopes of inputs"}
    assert {n for n, v in verdicts(found).items() if v is not Verdict.PASSED} == refused
    assert {a.use for a in found.allowances if not a.allowed} == {"resume", "sensitivity"}


@pytest.mark.parametrize("fault", CASES)
def test_a_liar_is_named(tmp_path: Path, fault: str) -> None:
    check, lie = CASES[fault]
    found = examine(liar(tmp_path, fault))
    assert verdicts(found)[check] is Verdict.FAILED
    assert lie is None or lie in found.lies


def test_what_is_not_promised_is_not_asked(tmp_path: Path) -> None:
    modest = 'canBeInstantiatedOnlyOncePerProcess="true"'
    found = examine(liar(tmp_path, capabilities=modest))
    assert verdicts(found)["instantiates twice"] is Verdict.NOT_OFFERED
    refused = [a.use for a in found.allowances if not a.allowed]
    assert refused == ["studies in one process", "resume", "sensitivity"]


def test_declared_feedthrough_is_no_lie(tmp_path: Path) -> None:
    found = examine(liar(tmp_path, "FEEDTHROUGH", dependencies="1"))
    assert found.healthy
