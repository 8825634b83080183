"""A description beside the default one that is faulty is left out with a warning; the default one
must be good."""

from pathlib import Path

import pytest

from harness.errors import ExperimentError
from harness.ssp.to_experiment import open_experiment
from tests.harness.fmi.archives import oscillator_fmu
from tests.harness.ssp.packages import archive, component, ssd

MAIN = "SystemStructure.ssd"
GOOD = ssd(f"<ssd:Elements>{component('left', source='resources/o.fmu')}</ssd:Elements>")
CASES = {
    "cut": (GOOD[:-9], "is no readable XML"),
    "unlike the schema": (GOOD.replace('version="1.0"', 'version="9"'), "version='9' is not legal"),
    "of a missing FMU": (
        GOOD.replace("o.fmu", "missing.fmu").replace("test", "other"),
        "there is no file",
    ),
}


def package(folder: Path, default: str, other: str) -> Path:
    content = oscillator_fmu(2).read_bytes()
    files = {MAIN: default, "other.ssd": other, "resources/o.fmu": content}
    return archive(folder / "two.ssp", files)


@pytest.mark.filterwarnings("ignore:.*states no")
@pytest.mark.parametrize("case", CASES)
def test_beside_a_good_one(tmp_path: Path, case: str) -> None:
    content, words = CASES[case]
    path = package(tmp_path, GOOD, content)
    told = pytest.warns(UserWarning, match=rf"the variant .*other\.ssd is left out: .*{words}")
    with told, open_experiment(path, {"stop_time": 0.1, "step": 0.01}) as experiment:
        assert experiment.variants == ("test",)
        assert len(experiment.run("test").time) == 11


@pytest.mark.filterwarnings("ignore:.*states no")
@pytest.mark.parametrize("case", CASES)
def test_in_its_place(tmp_path: Path, case: str) -> None:
    content, words = CASES[case]
    with (
        pytest.raises(ExperimentError, match=words),
        open_experiment(package(tmp_path, content, GOOD)),
    ):
        pass
