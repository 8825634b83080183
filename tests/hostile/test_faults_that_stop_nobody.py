"""Faults of a description that do no harm stop nobody who does not want them to; those that do harm
are refused all the same."""

import zipfile
from pathlib import Path

import pytest

from harness import simulate
from harness.cli.main import run_command_line
from harness.errors import FmuError, UsageError
from harness.fmi.fmu import Fmu
from harness.inspection.static import Severity, validate
from tests.harness.fmi.archives import rewritten
from tests.hostile.build import description, hostile_fmu
from tests.hostile.documents import BYTES, CHANGES, HARMLESS

TIMES = {"stop_time": 0.1, "step_size": 0.01}


def changed(folder: Path, old: str, new: str, fmi: int = 3) -> Path:
    text = description(fmi)
    assert old in text
    made = text.replace(old, new).encode()
    source = hostile_fmu(folder, fmi=fmi)
    return rewritten(source, folder / "changed.fmu", modelDescription_dot_xml=made)


@pytest.mark.parametrize(
    ("fmi", "old", "new"),
    [(3, 'start="0.1"', 'start="0.1" max="0.01"'),
     (2, '<Real start="0.1"/>', '<Real start="0.1" min="1"/>')],
)  # fmt: skip
def test_a_declared_start_value_may_lie_outside_its_limits(
    tmp_path: Path, fmi: int, old: str, new: str
) -> None:
    path = changed(tmp_path, old, new, fmi)
    assert len(simulate(path, **TIMES).time) == 11
    told = [p.text for p in validate(path) if p.severity is Severity.ERROR]
    assert len(told) == 1 and "its start value 0.1 lies outside its range" in told[0]


def test_a_given_one_may_not_unless_it_is_insisted_on(tmp_path: Path) -> None:
    path = changed(tmp_path, 'start="0.1"', 'start="0.1" max="0.5"')
    with pytest.raises(UsageError, match=r"start value of 'T' is 0\.7, above its max 0\.5"):
        simulate(path, **TIMES, start_values={"T": 0.7})
    result = simulate(path, **TIMES, start_values={"T": 0.7}, validate=False)
    assert "component hostile: start value of 'T' is 0.7, above its max 0.5" in result.notes


def test_the_command_lets_pass_what_it_is_told_to(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = changed(tmp_path, 'initial="exact" start="0.1"', 'initial="exact"')
    arguments = ["simulate", str(path), "--stop-time", "0.1", "--step-size", "0.01"]
    assert run_command_line(arguments) == 1
    refusal = capsys.readouterr().err
    assert "'T' that has no start value" in refusal and "--no-validate" in refusal
    assert run_command_line([*arguments, "--no-validate"]) == 0
    told = capsys.readouterr().err
    assert "note: modelDescription.xml of" in told and "has no start value" in told


@pytest.mark.parametrize("case", [*CHANGES, *HARMLESS])
def test_no_fault_does_harm_when_it_is_let_pass(tmp_path: Path, case: str) -> None:
    fmi, old, new, _ = {**CHANGES, **HARMLESS}[case]
    text = description(fmi).replace(old, new, 1 + (case == "wrong root")).encode()
    let_pass(tmp_path, text)


@pytest.mark.parametrize("case", BYTES)
def test_nor_do_bytes(tmp_path: Path, case: str) -> None:
    let_pass(tmp_path, BYTES[case][0])


def let_pass(folder: Path, text: bytes) -> None:
    """It is refused in one sentence, or read with its faults as notes."""
    path = folder / "case.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", text)
    try:
        with Fmu(path, validate=False) as fmu:
            assert fmu.notes and all(note.isprintable() for note in fmu.notes)
    except FmuError as fault:
        assert str(path) in str(fault) and str(fault).isprintable()


@pytest.mark.parametrize(
    ("fmi", "old", "new", "words"),
    [(3, 'modelIdentifier="hostile"', 'modelIdentifier="../x"', "no name of a file"),
     (3, 'name="y"', 'name="y" derivative="1"', "go in a circle"),
     (3, "<fmiModelDescription", "<!DOCTYPE a><fmiModelDescription", "has a DOCTYPE")],
)  # fmt: skip
def test_what_does_harm_is_refused(
    tmp_path: Path, fmi: int, old: str, new: str, words: str
) -> None:
    with pytest.raises(FmuError, match=words):
        Fmu(changed(tmp_path, old, new, fmi), validate=False)


def test_a_member_may_be_there_twice_with_one_content(tmp_path: Path) -> None:
    path = hostile_fmu(tmp_path)
    with zipfile.ZipFile(path, "a") as archive, pytest.warns(UserWarning, match="Duplicate"):
        archive.writestr("modelDescription.xml", description(3))
    assert len(simulate(path, **TIMES).time) == 11
