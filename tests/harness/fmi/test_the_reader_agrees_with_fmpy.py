"""What the reader says of a description is what FMPy's reader says, field by field."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings

from harness import registry
from tests.fuzz.mutations import changed
from tests.fuzz.targets import corpus
from tests.harness.cli.test_info_shows_arrays_clocks_and_aliases import DESCRIPTION
from tests.harness.fmi.archives import member, oscillator_fmu
from tests.harness.fmi.fmpy_oracle import both, compare
from tests.harness.inspection.liars import EXCHANGE_DESCRIPTION
from tests.harness.simulation.fmus import model_fmu
from tests.hostile.build import description

KINDS = ("1-slave", "1-model", "2", "3")


def documents() -> list[bytes]:
    """Descriptions of all versions and kinds that the tests have."""
    made = [description(fmi).encode() for fmi in (2, 3)]
    made += [DESCRIPTION.encode(), EXCHANGE_DESCRIPTION.encode(), *corpus("description")]
    fmus = [oscillator_fmu(2), oscillator_fmu(3), *map(model_fmu, KINDS)]
    made += [member(path, "modelDescription.xml") for path in fmus]
    return made


def test_of_all_documents_of_the_tests() -> None:
    found = [one for one in map(both, documents()) if one is not None]
    assert {one.fmi_major for one, _ in found} == {1, 2, 3}
    for ours, theirs in found:
        compare(ours, theirs)


@pytest.mark.parametrize("name", registry.names(registry.PLANTS))
def test_of_our_own_plants(name: str) -> None:
    for fmi in (2, 3):
        found = both(member(registry.plant_fmu(name, fmi), "modelDescription.xml"))
        assert found is not None
        compare(*found)


@settings(max_examples=150, suppress_health_check=list(HealthCheck))
@given(changed(documents()))
def test_of_changed_documents(content: bytes) -> None:
    found = both(content)
    if found is not None:
        compare(*found)
