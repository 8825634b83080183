"""`fmu-harness build` for controllers: registered, of an experiment, of one's own; refusals."""

from pathlib import Path

import pytest
from fmpy import read_model_description

from harness.cli.main import run_command_line

OWN = "tests.harness.cli.own_controller"


def build(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str]:
    code = run_command_line(["build", *map(str, arguments)])
    captured = capsys.readouterr()
    return code, captured.out + captured.err


def parameter(path: Path, name: str) -> str:
    variables = read_model_description(str(path)).modelVariables
    return str(next(v.start for v in variables if v.name == name))


def test_a_registered_one_with_parameters(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    code, text = build(
        capsys, "pid", "--sample-time", 0.02, "--set", "kp=2.5", "--output", tmp_path
    )
    assert code == 0, text
    for version in (2, 3):
        path = tmp_path / f"fmi{version}" / "pid.fmu"
        assert str(path) in text
        assert parameter(path, "parameters.kp") == "2.5"
        assert parameter(path, "parameters.sample_time") == "0.02"


def test_one_s_own_in_one_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    options = ("--sample-time", 0.1, "--set", "gain=3.0", "--fmi", 3, "--output", tmp_path)
    code, text = build(capsys, f"{OWN}:Proportional", *options)
    assert code == 0, text
    assert parameter(tmp_path / "fmi3" / "proportional.fmu", "parameters[1]") == "3.0"


def test_one_of_an_experiment(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    where = ("--experiment", "ahn2009/figure_7", "--variant", "pid", "--component", "controller")
    options = ("--name", "force pid", "--fmi", 2, "--output", tmp_path)
    code, text = build(capsys, *where, *options)
    assert code == 0, text
    description = read_model_description(str(tmp_path / "fmi2" / "force_pid.fmu"))
    assert "PID, controller of ahn2009/figure_7 (pid)." in description.description


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("pid", "--set", "kp=1"), 2, "needs its sample time in seconds, as in --sample-time"),
        (("pid", "--sample-time", "0.01", "--set", "kq=1"), 2, "no parameter 'kq'; did you mean"),
        (("pid", "--sample-time", "0"), 2, "sample time of pid must be positive"),
        (("pid", "--sample-time", "0.01"), 2, "controller pid needs kp, as in --set kp=VALUE"),
        (("pidd",), 2, "no plant or controller 'pidd'; did you mean 'pid'?"),
        (("hybrid_actuator", "--sample-time", "1"), 2, "are for controllers, not for plants"),
        (("--variant", "pid"), 2, "belong to --experiment NAME"),
        (("pid", "--experiment", "ahn2009/figure_7"), 2, "not both"),
        (
            ("--experiment", "ahn2009/figure_7", "--component", "controler"),
            2,
            "has no controller 'controler'; did you mean 'controller'?",
        ),
        ((f"{OWN}:on_off", "--sample-time", "0.1"), 2, "is plain Python, called with (time,"),
        ((f"{OWN}:Allocating", "--sample-time", "0.1"), 1, "own_controller.py:40 calls np.zeros()"),
    ],
)
def test_what_cannot_be_meant(
    capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], code: int, words: str
) -> None:
    found, text = build(capsys, *arguments)
    assert (found, words in text) == (code, True), text
    assert "Traceback" not in text
