"""`--no-validate` lets a system run whose FMU has a description that is refused otherwise."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from tests.harness.fmi.archives import oscillator_fmu, rewritten
from tests.harness.ssp.packages import archive, component, connector, ssd

EXPERIMENT = """title = "one"
stop_time = 0.1
[components.o]
fmu = "faulty.fmu"
"""


@pytest.fixture
def faulty(tmp_path: Path) -> Path:
    """An FMU with two variables of one name."""
    with zipfile.ZipFile(oscillator_fmu(2)) as opened:
        text = opened.read("modelDescription.xml").decode()
    assert 'name="damping"' in text
    twice = text.replace('name="damping"', 'name="mass"').encode()
    return rewritten(oscillator_fmu(2), tmp_path / "faulty.fmu", modelDescription_dot_xml=twice)


def package(faulty: Path) -> Path:
    one = component("o", connector("position", "output"), source="faulty.fmu")
    text = ssd(f"<ssd:Elements>{one}</ssd:Elements>", '<ssd:DefaultExperiment stopTime="0.1"/>')
    files = {"SystemStructure.ssd": text, "faulty.fmu": faulty.read_bytes()}
    return archive(faulty.parent / "one.ssp", files)


def experiment(faulty: Path) -> Path:
    path = faulty.parent / "one.toml"
    path.write_text(EXPERIMENT)
    return path


@pytest.mark.filterwarnings("ignore:.*states no")
@pytest.mark.parametrize("make", [package, experiment])
def test_run(
    faulty: Path, make: Callable[[Path], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["run", str(make(faulty)), "--output", str(tmp_path / "run")]
    assert run_command_line(arguments) != 0
    assert "'mass' twice" in (refusal := capsys.readouterr().err.replace('"', "'"))
    assert "--no-validate" in refusal
    arguments[-1] += "2"
    assert run_command_line([*arguments, "--no-validate"]) == 0
    assert "'mass' twice" in capsys.readouterr().err.replace('"', "'")
    assert list((tmp_path / "run2").rglob("*.csv"))


def test_timing(faulty: Path) -> None:
    arguments = ["timing", str(experiment(faulty))]
    assert run_command_line(arguments) != 0
    assert run_command_line([*arguments, "--no-validate"]) == 0
