"""The command line ends with 0, 1 or 2, and a fault is one sentence without a traceback."""

from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from tests.harness.experiment.loops import FILE, write
from tests.harness.fmi.archives import oscillator_fmu

BAD_UNIT = FILE.replace("final = 2.0 }", 'final = 2.0, unit = "m" }').replace(
    "u_max = 10.0 }", 'u_max = 10.0, measured_unit = "N" }'
)


def command(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    code = run_command_line(list(arguments))
    captured = capsys.readouterr()
    assert "Traceback" not in captured.err + captured.out
    return code, captured.err


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("run", "ahn2009/figure_77"), 2, "no experiment 'ahn2009/figure_77'; did you mean"),
        (("run", "missing.toml"), 2, "experiment file missing.toml does not exist"),
        (("run", "ahn2009/figure_7", "--set", "seed"), 2, "must have the form key=value"),
        (("run", "ahn2009/figure_7", "--set", "sead=3"), 2, "key sead: unknown key; did you mean"),
        (("run", "ahn2009/figure_7", "--set", "seed=-3"), 2, "key seed"),
        (
            ("run", "ahn2009/figure_7", "--variant", "pdi"),
            2,
            "no variant 'pdi'; did you mean 'pid'",
        ),
        (("build", "hybrid_actuater"), 2, "no plant or controller 'hybrid_actuater'; did you mean"),
        (("build", "hybrid_actuator", "--fmi", "1"), 2, "FMI version 1 cannot be built"),
        (("info", "missing.fmu"), 1, "FMU missing.fmu is not a file"),
        (("timing", "nothing"), 2, "no experiment 'nothing'"),
        (("rnu",), 2, "No such command 'rnu'"),
        (("run",), 2, "Missing argument"),
    ],
)
def test_code_and_sentence(
    capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], code: int, words: str
) -> None:
    found, text = command(capsys, *arguments)
    assert (found, words in text) == (code, True), text


@pytest.mark.parametrize(
    ("name", "content"),
    [("text.fmu", b"just text"), ("cut.fmu", b"PK\x03\x04\x14\x00"), ("empty.fmu", b"")],
)
def test_files_that_are_no_fmu(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, name: str, content: bytes
) -> None:
    (tmp_path / name).write_bytes(content)
    code, text = command(capsys, "info", str(tmp_path / name))
    assert code == 1 and "cannot be unpacked" in text and text.startswith("error: ")


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        (FILE.replace("seed = 5", "sead = 5"), 2, "lag.toml: key sead: unknown key"),
        (BAD_UNIT, 2, "'m' (m) cannot be converted to 'N' (kg.m.s-2)"),
        (FILE.replace("stop_time", "stop_tim"), 2, "key stop_time: this key is required"),
        ("title = ", 2, "is no valid TOML"),
    ],
)
def test_experiment_files(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, text: str, code: int, words: str
) -> None:
    path = write(tmp_path, text)
    found, error = command(capsys, "run", str(path), "--output", str(tmp_path / "out"))
    assert (found, words in error) == (code, True), error


def test_a_run_that_ends_early_reports_and_keeps_what_there_is(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    text = FILE.replace(
        "[variants.soft]", "[variants.soft]\ncomponents.lag.parameters.gain = 1e300"
    )
    code, error = command(
        capsys, "run", str(write(tmp_path, text)), "--output", str(tmp_path / "o")
    )
    assert code == 1 and "error: soft PID: output lag.y is" in error
    assert (tmp_path / "o" / "hard" / "results.csv").is_file()
    assert '"incomplete"' in (tmp_path / "o" / "soft" / "manifest.json").read_text()


def test_an_output_that_is_a_file_is_named_as_such(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = write(tmp_path)
    code, error = command(capsys, "run", str(path), "--output", str(path))
    assert code == 1 and f"error: cannot make the run folder {path}: File exists" in error


@pytest.mark.parametrize("name", ["info", "validate", "verify"])
def test_ctrl_c_ends_any_command_with_a_sentence(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    fmu = str(oscillator_fmu(3))
    monkeypatch.setattr("zipfile.ZipFile.__init__", interrupted)
    code, error = command(capsys, name, fmu)
    assert (code, error) == (1, "error: interrupted by Ctrl-C\n")
