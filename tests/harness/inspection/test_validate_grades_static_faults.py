"""`validate` lists static faults with their severity, and runs nothing."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import pytest

from harness import registry
from harness.cli.main import run_command_line
from harness.inspection.static import Problem, Severity, validate
from tests.harness.inspection.liars import liar
from tests.hostile.build import hostile_fmu

CASES = [
    ('<Real start="0"/>', '<Real start="7" max="5"/>', Severity.ERROR, "7 lies outside its range"),
    ('<Real start="0"/>', '<Real start="0" min="3" max="1"/>', Severity.ERROR, "min 3 above max 1"),
    ('start="0"/>', 'start="zero"/>', Severity.ERROR, "zero"),
    ('name="u"', 'name="y"', Severity.ERROR, "not unique"),
    ('index="2"', 'index="1"', Severity.ERROR, "Outputs"),
    ('canGetAndSetFMUstate="true"', 'canSerializeFMUstate="true"', Severity.ERROR, "serialise"),
    (' dependencies="DEPENDENCIES"', "", Severity.WARNING, "no statement on which inputs"),
    ("canGetAndSetFMUstate", "canBeInstantiatedOnlyOncePerProcess", Severity.WARNING, "one inst"),
    ('canGetAndSetFMUstate="true"', "", Severity.NOTE, "no rollback"),
    (' stepSize="0.1"', "", Severity.NOTE, "suggests no step size"),
    (' stopTime="2"', "", Severity.NOTE, "suggests no stop time"),
]  # fmt: skip


def graded(problems: tuple[Problem, ...], severity: Severity) -> str:
    return "; ".join(f"{p.place}: {p.text}" for p in problems if p.severity is severity)


@pytest.mark.parametrize(("old", "new", "severity", "words"), CASES)
def test_a_fault_has_its_severity(
    tmp_path: Path, old: str, new: str, severity: Severity, words: str
) -> None:
    assert words not in graded(validate(liar(tmp_path)), severity)
    assert words in graded(validate(liar(tmp_path, change=(old, new))), severity)


@pytest.mark.parametrize("portable", [False, True], ids=["native", "portable"])
@pytest.mark.parametrize("name", registry.names(registry.PLANTS))
def test_our_own_have_none(name: str, portable: bool) -> None:
    path = registry.plant_fmu(name, 2 if portable else 3, portable=portable)
    assert graded(validate(path), Severity.ERROR) == graded(validate(path), Severity.WARNING) == ""


def without(path: Path, target: Path, part: str) -> Path:
    with zipfile.ZipFile(path) as source, zipfile.ZipFile(target, "w") as made:
        for name in source.namelist():
            if part not in name:
                made.writestr(name, source.read(name))
    return target


def test_an_fmu_without_binaries_runs_nowhere(tmp_path: Path) -> None:
    bare = without(liar(tmp_path), tmp_path / "bare.fmu", "binaries")
    assert "runs nowhere" in graded(validate(bare), Severity.ERROR)


def test_nothing_is_run(tmp_path: Path) -> None:
    """The library of this one ends the process as soon as it is loaded."""
    assert graded(validate(hostile_fmu(tmp_path, "load exit 0 3")), Severity.ERROR) == ""


def test_exit_codes_and_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["validate", str(liar(tmp_path))]) == 0
    capsys.readouterr()
    bad = liar(tmp_path, change=('name="u"', 'name="y"'))
    assert run_command_line(["validate", "--json", str(bad)]) == 1
    shown = capsys.readouterr()
    assert json.loads(shown.out)[0]["severity"] == "error"
    assert run_command_line(["validate", str(tmp_path / "missing.fmu")]) == 1
    assert "is not a file" in capsys.readouterr().out
