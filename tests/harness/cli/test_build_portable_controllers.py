"""`fmu-harness build --portable` for controllers: made, certified, and verified by its command."""

from pathlib import Path
from zipfile import ZipFile

import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu

from harness.cli.main import run_command_line

PID = ("pid", "--sample-time", 0.01, "--set", "kp=1.0")
EXPERIMENT = ("--experiment", "ahn2009/figure_7", "--variant", "pid", "--component", "controller")


def command(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str]:
    code = run_command_line([*map(str, arguments)])
    captured = capsys.readouterr()
    return code, captured.out + captured.err


@pytest.mark.parametrize(
    ("arguments", "made"),
    [
        (PID, {"portable/pid.fmu": 2}),
        ((*PID, "--fmi", 3), {"portable-fmi3/pid.fmu": 3}),
        ((*PID, "--fmi", 2, "--fmi", 3), {"portable/pid.fmu": 2, "portable-fmi3/pid.fmu": 3}),
        ((*EXPERIMENT, "--name", "force"), {"portable/force.fmu": 2}),
        ((*EXPERIMENT, "--fmi", 3), {"portable-fmi3/controller.fmu": 3}),
    ],
)
def test_each_is_made_and_holds_its_certificate(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, arguments: tuple[object, ...],
    made: dict[str, int],
) -> None:  # fmt: skip
    code, text = command(capsys, "build", *arguments, "--portable", "--output", tmp_path)
    assert code == 0, text
    assert {p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*.fmu")} == set(made)
    for name, version in made.items():
        path = tmp_path / name
        assert read_model_description(str(path)).fmiVersion[0] == str(version)
        assert validate_fmu(str(path)) == []
        with ZipFile(path) as archive:
            assert any(one.startswith("resources/") for one in archive.namelist())
        code, text = command(capsys, "verify", path)
        assert code == 0, text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((*PID, "--targets", "win64"), "--targets are for native FMUs"),
        ((*PID, "--fmi", 4), "FMI version 4 cannot be built; choose 2 or 3"),
    ],
)
def test_what_cannot_be_meant(
    capsys: pytest.CaptureFixture[str], arguments: tuple[object, ...], words: str
) -> None:
    code, text = command(capsys, "build", *arguments, "--portable")
    assert (code, words in text) == (2, True), text
