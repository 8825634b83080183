"""FMI 1, 2 and 3 in each kind: what a version cannot offer is no fault, events and clocks are."""

from __future__ import annotations

import pytest

from harness.inspection.doctor import Diagnosis, examine
from harness.inspection.finding import Verdict
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler

ABSENT = {"restores a snapshot", "serialises its state", "derivatives"}
"""What FMI 1 has no functions for, and this model does not offer in the others."""


def checks(found: Diagnosis, verdict: Verdict, kind: str) -> set[str]:
    return {f.check for f in found.findings if f.verdict is verdict and f.interface_type == kind}


@pytest.mark.parametrize(
    ("version", "kind", "absent"),
    [
        ("1-slave", "co-simulation", {"takes slopes of inputs"}),
        ("1-model", "model-exchange", {"resets"}),
    ],
)
def test_fmi_1_is_healthy_and_closes_loops(version: str, kind: str, absent: set[str]) -> None:
    found = examine(model_fmu(version))
    assert found.healthy
    assert checks(found, Verdict.NOT_OFFERED, kind) == ABSENT | absent
    allowed = {a.use for a in found.allowances if a.allowed}
    assert {f"simulate, {kind.replace('-e', ' e')}", "jacobi and gauss-seidel"} <= allowed
    assert not {"iterative", "resume", "sensitivity"} & allowed


def test_both_kinds_stand_on_one_page() -> None:
    found = examine(model_fmu("2"))
    assert found.healthy
    assert checks(found, Verdict.NOT_OFFERED, "co-simulation") >= ABSENT
    assert checks(found, Verdict.PASSED, "model-exchange") >= {"returns its states", "resets"}
    assert [a.use for a in found.allowances[:2]] == [
        "simulate, co-simulation",
        "simulate, model exchange",
    ]


def test_clocks_tick_alike_in_every_run() -> None:
    """This one's reset does nothing, which shows; all else repeats, with events and clocks."""
    found = examine(model_fmu("3"))
    for kind in ("co-simulation", "model-exchange"):
        assert checks(found, Verdict.FAILED, kind) == {"resets"}
        assert "repeats in a new process" in checks(found, Verdict.PASSED, kind)
