"""What a newcomer types first: the version, the example of the bench, a plot without a display, a
plant of one's own under another name."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

import harness.bench
from fmus.declaration import Parameter
from fmus.packaging.errors import PackagingError
from harness.cli.main import run_command_line
from harness.fmi.fmu import Fmu
from harness.registry import plant_fmu
from tests.fmus.packaging.plants import static_gain


def test_the_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["--version"]) == 0
    assert re.fullmatch(r"fmu-harness \d+\.\d+\S*\n", capsys.readouterr().out)


def test_the_example_of_the_bench_runs() -> None:
    lines = (harness.bench.__doc__ or "").splitlines()
    code = "\n".join(line.removeprefix("    ") for line in lines if line.startswith("    "))
    scope = {"Bench": harness.bench.Bench}
    exec(code, scope)
    assert abs(scope["result"]["plant.force"][-1] - 2000.0) < 200.0  # type: ignore[index]


@pytest.mark.parametrize("display", [None, ":99"])
def test_a_plot_without_a_display_is_told_and_nothing_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
    display: str | None,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    shown: list[str] = []
    monkeypatch.setattr("typer.launch", shown.append)
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    if display is not None:
        monkeypatch.setenv("DISPLAY", display)
    fmu = str(plant_fmu("oscillator_left"))
    assert run_command_line(["simulate", fmu, "--show-plot", "--stop-time", "0.1"]) == 0
    assert ("no display" in capsys.readouterr().err) == (display is None)
    assert len(shown) == (display is not None) and not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["oscillator_left", "fmus.oscillator_left.model:plant"])
def test_a_plant_under_another_name(tmp_path: Path, name: str) -> None:
    command = ["build", name, "--name", "my-left", "--fmi", "3", "--output", str(tmp_path)]
    assert run_command_line(command) == 0
    with Fmu(tmp_path / "fmi3" / "my_left.fmu") as fmu:
        assert fmu.description.name == "my_left"


@pytest.mark.parametrize("unit", ["m2.5/s", ""])
def test_a_unit_that_is_none_names_whose_it_is(unit: str) -> None:
    plant = replace(static_gain, parameters=(Parameter("gain", unit, "k", 1.0, "ours"),))
    with pytest.raises(PackagingError, match=r"parameter 'gain': The unit .* has '1'"):
        plant.fmu(3)
