"""`fmu-harness simulate`: CSV in and out, plot, band, cross-check files, exit codes."""

import math
import shutil
from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from tests.harness.simulation.fmus import model_fmu, needs_compiler

pytestmark = needs_compiler
FMU = "2"


def simulate(*arguments: object) -> int:
    return run_command_line(["simulate", *map(str, arguments)])


def test_a_csv_file_a_plot_and_a_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, plot = tmp_path / "out.csv", tmp_path / "plots" / "p.png"
    code = simulate(
        model_fmu(FMU), "--stop-time", 1, "--step-size", 0.25, "--output-file", out,
        "--plot-file", plot, "--output-variables", "x", "--output-variables", "der*",
        "--start-values", "x=2", "--start-values", "k=0",
    )  # fmt: skip
    shown = capsys.readouterr().out
    assert code == 0 and "der(x)" in shown and f"written: {out}" in shown
    lines = out.read_text().splitlines()
    assert lines[0] == '"time","x","der(x)","der(v)","der(h)"'
    assert [line.split(",")[:2] for line in lines[1:]] == [
        [t, "2"] for t in ("0", "0.25", "0.5", "0.75", "1")
    ]
    assert plot.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_model_exchange_and_a_reference(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ref = tmp_path / "ref.csv"
    rows = [f"{t / 10},{math.exp(-t / 10)}" for t in range(11)]
    ref.write_text("time,x\n" + "\n".join(rows))
    common = ["--interface-type", "model-exchange", "--stop-time", 1, "--output-interval", 0.1]
    assert simulate(model_fmu(FMU), *common, "--validate-against", ref) == 0
    assert "agrees" in capsys.readouterr().out
    wrong = ["--start-values", "k=1.1", "--validate-against", ref, "--time-band", 0]
    assert simulate(model_fmu(FMU), *common, *wrong) == 1
    assert "1 of 1 variables leave the band" in capsys.readouterr().err


def test_what_lies_beside_the_fmu_is_used(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fmu, out = tmp_path / "Model.fmu", tmp_path / "out.csv"
    shutil.copy(model_fmu(FMU), fmu)
    (tmp_path / "Model_ref.opt").write_text(
        "StartTime, 0.0\nStopTime, 2\nStepSize, 0\nRelTol, 1e-4"
    )
    (tmp_path / "Model_in.csv").write_text('"time","u"\n0,5\n2,5\n')
    assert simulate(fmu, "--step-size", 1, "--output-file", out, "--output-variables", "u") == 0
    assert out.read_text() == '"time","u"\n0,5\n1,5\n2,5\n'
    notes = capsys.readouterr().err
    assert "Model_ref.opt" in notes and "Model_in.csv" in notes
    assert simulate(fmu, "--stop-time", 1, "--step-size", 1, "--output-file", out) == 0
    assert out.read_text().splitlines()[-1].startswith("1,")


def test_messages_are_printed_where_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    code = simulate(model_fmu("1-slave"), "--stop-time", 1, "--step-size", 0.1, "--fmi-logging",
                    "--start-values", "end=0.5")  # fmt: skip
    assert code == 1 and "[Error] error: no step beyond 0.5 s" in capsys.readouterr().err


def test_rows_before_a_fault_are_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.csv"
    common = ["--stop-time", 1, "--step-size", 0.25, "--start-values", "end=0.6"]
    chosen = ["--output-file", out, "--output-variables", "counter"]
    assert simulate(model_fmu("1-slave"), *common, *chosen) == 1
    assert "returned Error: no step beyond 0.6 s" in capsys.readouterr().err
    assert out.read_text() == '"time","counter"\n0,0\n0.25,1\n0.5,2\n'


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--start-values", "x"), "must have the form name=value"),
        (("--interface-type", "xe"), "interface type 'xe' is unknown"),
        (("--step-size", "-1"), "step size must be positive"),
        (("--output-variables", "nothing*"), "nothing to record matches 'nothing*'"),
        (("--step-size", "abc"), "Invalid value for '--step-size'"),
    ],
)
def test_usage_faults_have_exit_code_2(
    arguments: tuple[str, ...], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert simulate(model_fmu(FMU), *arguments) == 2
    text = " ".join(capsys.readouterr().err.split())
    assert words in text and "Traceback" not in text


@pytest.mark.parametrize(
    ("option", "words"),
    [("--input-file", "cannot be read"), ("--validate-against", "cannot be read")],
)
def test_missing_files_are_named(
    tmp_path: Path, option: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = tmp_path / "missing.csv"
    assert simulate(model_fmu(FMU), "--stop-time", 0.1, option, missing) in (1, 2)
    text = capsys.readouterr().err
    assert str(missing) in text and words in text and "Traceback" not in text


def test_a_folder_that_cannot_be_written_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / "no" / "out.csv"
    assert simulate(model_fmu(FMU), "--stop-time", 0.1, "--output-file", target) == 1
    assert f"{target} cannot be written" in capsys.readouterr().err
