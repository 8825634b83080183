"""A plant's archives are the same bytes wherever and whenever they are built; tokens differ."""

from pathlib import Path

import pytest
from fmpy import read_model_description

from fmus.plant import Plant
from harness import registry
from tests.fmus.conformance.conftest import NAMES
from tests.fmus.conformance.processes import run_python

REBUILD = """
import sys
from pathlib import Path
from fmus.packaging.plant.build import fmu_file
from harness import registry
plant = registry.plant(sys.argv[1])
for version, portable in ((2, False), (3, False), (2, True)):
    fmu_file(plant, version, Path(f"{version}{'portable' * portable}"), portable=portable)
"""


@pytest.fixture(scope="module")
def rebuilt(plant: Plant, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All FMUs of a plant from another process, folder and hash seed, into an empty cache."""
    folder = tmp_path_factory.mktemp("rebuilt")
    changed = {
        "FMU_HARNESS_CACHE": str(folder / "cache"),
        "PYTHONHASHSEED": "7",
        "TZ": "Asia/Tokyo",
    }
    run_python("-c", REBUILD, plant.name, cwd=folder, changed=changed)
    return folder


def token(path: Path) -> str:
    description = read_model_description(str(path))
    return str(description.guid or description.instantiationToken)


def test_same_bytes(plant: Plant, rebuilt: Path) -> None:
    for version, portable in ((2, False), (3, False), (2, True)):
        other = rebuilt / f"{version}{'portable' * portable}" / f"{plant.name}.fmu"
        here = plant.fmu(version, portable=portable)
        assert other.read_bytes() == here.read_bytes()
        assert not other.samefile(here)


def test_every_fmu_has_a_token_of_its_own() -> None:
    plants: list[Plant] = [registry.plant(name) for name in NAMES]
    tokens = [token(p.fmu(version)) for p in plants for version in (2, 3)]
    tokens += [token(p.fmu(2, portable=True)) for p in plants]
    assert len(set(tokens)) == 3 * len(plants)
