"""FMPy's validator has nothing to say about any FMU, native or portable."""

import pytest
from fmpy.validation import validate_fmu

from fmus.packaging.plant.build import cached_fmu
from fmus.plant import Plant
from tests.fmus.packaging.plants import ALL


@pytest.mark.parametrize("plant", ALL, ids=lambda plant: plant.name)
def test_native(plant: Plant, version: int) -> None:
    assert validate_fmu(str(cached_fmu(plant, version))) == []


@pytest.mark.parametrize("plant", ALL, ids=lambda plant: plant.name)
def test_portable(plant: Plant) -> None:
    assert validate_fmu(str(cached_fmu(plant, 2, portable=True))) == []
