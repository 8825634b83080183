"""Each command does its work and prints what one needs of it."""

import json
import zipfile
from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from tests.harness.experiment.loops import write
from tests.harness.fmi.archives import oscillator_fmu


def shown(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    code = run_command_line(list(arguments))
    captured = capsys.readouterr()
    assert code == 0, captured.err
    return captured.out


def test_list_names_all_that_can_be_named(capsys: pytest.CaptureFixture[str]) -> None:
    text = shown(capsys, "list")
    for word in ("hybrid_actuator", "disturbance_generator", "pid", "fuzzy_pid", "tuned_fuzzy_pid",
                 "ahn2009/figure_7", "white_noise", "step", "noise", "quantisation"):  # fmt: skip
        assert word in text, word


@pytest.mark.parametrize("version", [2, 3])
def test_info_as_json(capsys: pytest.CaptureFixture[str], version: int) -> None:
    data = json.loads(shown(capsys, "info", str(oscillator_fmu(version)), "--json"))
    assert data["name"] == "oscillator" and data["fmi_version"] == f"{version}.0"
    assert data["co_simulation"]["provides_directional_derivatives"] is True
    variables = {v["name"]: v for v in data["variables"]}
    assert variables["force"]["causality"] == "input" and variables["force"]["unit"] == "N"
    assert data["feedthrough"] == {"position": [], "spring_force": [], "acceleration": ["force"]}
    assert data["states"] == [["position", "der(position)"], ["velocity", "der(velocity)"]]
    assert len(data["sha256"]) == 64


def test_info_for_people(capsys: pytest.CaptureFixture[str]) -> None:
    text = shown(capsys, "info", str(oscillator_fmu(3)))
    for word in ("oscillator", "directional derivatives", "spring_force", "stiffness", "N/m"):
        assert word in text, word


def test_build_writes_fmus_by_version(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    text = shown(capsys, "build", "disturbance_generator", "--output", str(tmp_path))
    for version in (2, 3):
        path = tmp_path / f"fmi{version}" / "disturbance_generator.fmu"
        assert str(path) in text and zipfile.is_zipfile(path)


def test_run_writes_rows_table_and_picture(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    text = shown(capsys, "run", str(write(tmp_path)), "--output", str(out), "--set", "seed=9")
    assert "loops/lag: A lag under PID" in text and "soft PID" in text and "iae" in text.lower()
    assert (out / "response.png").stat().st_size > 1000
    assert (out / "metrics.csv").read_text().startswith("variant,metric,value,unit\n")
    for variant in ("soft", "hard"):
        manifest = json.loads((out / variant / "manifest.json").read_text())
        assert manifest["seeds"] == {"seed": 9}
        assert manifest["status"]["state"] == "complete"


def test_one_variant_only(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    arguments = ("run", str(write(tmp_path)), "--output", str(tmp_path / "o"), "--variant", "hard")
    assert "soft PID" not in shown(capsys, *arguments)
    assert not (tmp_path / "o" / "soft").exists()


def test_timing_prints_the_schedule_and_measures_the_delay(
    capsys: pytest.CaptureFixture[str],
) -> None:
    arguments = ("timing", "ahn2009/figure_7", "--set")
    text = shown(capsys, *arguments, 'connections."plant.command".delay=0.013')
    for line in ("sample signal reference", "read plant: force", "compute controller",
                 "record a row", "step plant by 3 ms", "step plant by 7 ms"):  # fmt: skip
        assert line in text, line
    assert "13 ms" in text and "1.3" in text, "measured: the pulse arrives 1.3 samples later"
