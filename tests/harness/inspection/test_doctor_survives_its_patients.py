"""Whatever an FMU does to its process, the doctor names the check and goes on with the rest."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from harness.inspection.doctor import Diagnosis, examine
from harness.inspection.finding import Finding, Verdict
from tests.hostile.build import hostile_fmu


def failures(found: Diagnosis) -> dict[str, Finding]:
    return {f.check: f for f in found.findings if f.verdict is Verdict.FAILED}


@pytest.mark.parametrize(
    ("behaviour", "words"),
    [
        ("Reset segfault", "SIGSEGV"),
        ("Reset abort", "SIGABRT"),
        ("Reset exit 0 0", "ended the process with exit code 0"),
        ("Reset exit 0 7", "exit code 7"),
        ("Reset killed", "SIGKILL"),
        ("Reset overflow", "SIGSEGV"),
        ("Reset hang", "no end within 15 s"),
        ("Reset error", "fmi2Reset returned Error"),
    ],
)
def test_the_other_checks_go_on(tmp_path: Path, behaviour: str, words: str) -> None:
    found = examine(hostile_fmu(tmp_path, behaviour, fmi=2), deadline=15.0)
    failed = failures(found)
    assert set(failed) == {"resets"}
    assert words in failed["resets"].detail
    assert len(found.findings) >= 9


def test_no_deadline_is_too_short_for_a_process_to_start(tmp_path: Path) -> None:
    found = examine(hostile_fmu(tmp_path, fmi=2), deadline=0.001)
    assert {f.check for f in found.findings} >= {"runs", "resets", "survives 200 instances"}
    assert "no end within 0.001 s" in failures(found)["survives 200 instances"].detail


def test_an_fmu_that_dies_while_it_loads_fails_every_check(tmp_path: Path) -> None:
    found = examine(hostile_fmu(tmp_path, "load segfault"), deadline=5.0)
    asked = [f for f in found.findings if f.verdict is not Verdict.NOT_OFFERED]
    assert len(asked) >= 7 and all("SIGSEGV" in f.detail for f in asked)
    assert not any(a.allowed for a in found.allowances)


def test_an_fmu_that_dies_at_the_end_is_noticed(tmp_path: Path) -> None:
    found = examine(hostile_fmu(tmp_path, "unload segfault"), deadline=15.0)
    assert set(failures(found)) == {"lets its process end"}


def test_the_command_line_gives_json_and_exit_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sick = hostile_fmu(tmp_path, "Reset segfault", fmi=2)
    assert run_command_line(["doctor", str(sick), "--json"]) == 1
    shown = capsys.readouterr()
    data = json.loads(shown.out)
    assert data["healthy"] is False and data["allowed"]["jacobi and gauss-seidel"] is True
    assert "1 of 13 checks failed" in shown.err
    well = hostile_fmu(tmp_path / "well", fmi=3)
    assert run_command_line(["doctor", str(well)]) == 0
    assert "restores a snapshot" in capsys.readouterr().out
