"""What readers of packages need though SSP does not ask for it, each found by such a reader."""

import re
from pathlib import Path

import pytest

from harness.experiment.experiment import Experiment
from harness.export.verify import verify
from harness.fmi.archive.unpack import Archive
from harness.ssp.from_experiment import export_experiment
from harness.ssp.package import DEFAULT, open_package
from tests.harness.ssp.test_exported_experiments_come_back import loop

pytestmark = pytest.mark.filterwarnings("ignore:in other tools")


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Archive:
    folder = tmp_path_factory.mktemp("package")
    experiment = Experiment.from_data(loop(), folder / "loop.toml")
    export_experiment(experiment, folder / "loop.ssp", experiment.variants)
    return Archive(folder / "loop.ssp", DEFAULT)


@pytest.fixture
def text(package: Archive) -> str:
    return (package.folder / "SystemStructure.ssd").read_text()


def test_the_algorithm_has_no_attributes(text: str) -> None:
    """libcosim takes a declaration of the namespace there for an unknown algorithm."""
    assert '<osp:Algorithm><osp:FixedStepAlgorithm baseStepSize="0.01"/></osp:Algorithm>' in text
    assert "xmlns:osp=" in text.partition("<ssd:System ")[0]


def test_inputs_that_nobody_drives_are_not_listed(tmp_path: Path) -> None:
    """FMPy drives such an input by what drives the one before it."""
    data = loop()
    del data["connections"]["pid.reference"]
    del data["measure"]
    experiment = Experiment.from_data(data, tmp_path / "loop.toml")
    export_experiment(experiment, tmp_path / "loop.ssp", experiment.variants)
    with open_package(tmp_path / "loop.ssp") as opened:
        system = next(iter(opened.structures.values())).system
    inputs = {
        f"{element.name}.{one.name}"
        for element in system.elements
        for one in element.connectors
        if one.kind == "input"
    }
    assert inputs == {"pid.measured", "plant.force"}


def test_both_numbers_of_a_transformation_are_written(tmp_path: Path) -> None:
    """Ecos takes a factor that is not there for zero."""
    data = loop()
    data["connections"]["plant.force"] = {"from": "pid.u", "offset": 0.125}
    experiment = Experiment.from_data(data, tmp_path / "loop.toml")
    export_experiment(experiment, tmp_path / "loop.ssp", experiment.variants)
    with Archive(tmp_path / "loop.ssp", DEFAULT) as opened:
        found = (opened.folder / "SystemStructure.ssd").read_text()
    assert re.search(r'<ssc:LinearTransformation factor="1(\.0)?" offset="0\.125"/>', found)


def test_every_fmu_without_inputs_is_certified_too(package: Archive) -> None:
    for name in ("reference", "pid"):
        assert verify(package.folder / "resources" / f"{name}.fmu").exact


def test_a_conversion_of_units_is_said_aloud(tmp_path: Path) -> None:
    """Neither Ecos nor libcosim converts units."""
    data = loop()
    data["components"]["pid"]["parameters"]["output_unit"] = "kN"
    experiment = Experiment.from_data(data, tmp_path / "loop.toml")
    with pytest.warns(UserWarning, match=r"the conversion of kN to N on pid\.u -> plant\.force"):
        export_experiment(experiment, tmp_path / "loop.ssp", experiment.variants)
