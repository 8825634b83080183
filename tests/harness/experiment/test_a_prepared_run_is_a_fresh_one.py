"""What is prepared once gives the bits of a fresh run, whatever was run on it before."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from harness.errors import HarnessError, UsageError
from harness.experiment.experiment import Experiment
from tests.harness.experiment.loops import MACHINE, load

START = "components.plant.start_values"


def fresh(folder: Path, variant: str, seed: int, start: Mapping[str, float]) -> bytes:
    changes = [f"{START}.{name}={value}" for name, value in start.items()]
    return load(folder, MACHINE, *changes).run(variant, seed=seed).data.tobytes()


CASES = [(3, {}), (4, {"speed": -2.0}), (3, {"angle_deviation": 0.7, "speed": 0.0}), (3, {})]


@pytest.mark.parametrize("variant", ["light", "heavy"])
def test_other_seeds_and_start_values(tmp_path: Path, variant: str) -> None:
    seen = set()
    with load(tmp_path, MACHINE).prepare(variant) as prepared:
        for seed, start in [*CASES, *reversed(CASES)]:
            result = prepared.run(seed=seed, start_values={"plant": start})
            assert result.data.tobytes() == fresh(tmp_path, variant, seed, start)
            seen.add(result.data.tobytes())
    assert len(seen) == 3


def test_its_manifest_says_what_was_run(tmp_path: Path) -> None:
    with load(tmp_path, MACHINE).prepare("heavy") as prepared:
        result = prepared.run(tmp_path / "run", seed=9, start_values={"plant": {"speed": 1.25}})
        again = prepared.run()
    whole = load(tmp_path, MACHINE, f"{START}.speed=1.25").run("heavy", seed=9)
    assert result.manifest.experiment == whole.manifest.experiment
    assert result.manifest.seeds == {"seed": 9} and again.manifest.seeds == {"seed": 3}
    assert again.manifest.experiment["components"]["plant"]["start_values"]["speed"] == 0.5


def test_a_run_that_ends_early_leaves_the_next_one_as_it_was(tmp_path: Path) -> None:
    with load(tmp_path, MACHINE).prepare("light") as prepared:
        with pytest.raises(HarnessError) as caught:
            prepared.run(start_values={"plant": {"speed": 1e300}})
        assert caught.value.result is not None
        assert prepared.run().data.tobytes() == fresh(tmp_path, "light", 3, {})


def test_a_plain_python_object_starts_anew_each_time(tmp_path: Path) -> None:
    experiment = load(tmp_path)
    expected = experiment.run("soft")
    with experiment.prepare("soft") as prepared:
        runs = [prepared.run() for _ in range(3)]
    assert {run.data.tobytes() for run in runs} == {expected.data.tobytes()}
    assert [run.metrics for run in runs] == 3 * [expected.metrics]


def test_a_bench_can_be_prepared_too(tmp_path: Path) -> None:
    bench = load(tmp_path, MACHINE).bench("light")
    with bench.prepare() as prepared:
        assert prepared.repeatable
        rows = {prepared.run(seed=seed).data.tobytes() for seed in (3, 5, 3)}
    assert rows == {bench.run().data.tobytes(), fresh(tmp_path, "light", 5, {})}
    with load(tmp_path).bench("soft").prepare() as remembering:
        rows = {remembering.run().data.tobytes() for _ in range(3)}
        assert remembering.repeatable and len(rows) == 1


@pytest.mark.parametrize(
    ("start", "words"),
    [
        ({"plnt": {"speed": 0.0}}, "start values of 'plnt', which is no FMU; did you mean 'plant'"),
        ({"plant": {"sped": 0.0}}, "no variable 'sped'.*'speed'"),
    ],
)
def test_start_values_are_checked(
    tmp_path: Path, start: dict[str, dict[str, float]], words: str
) -> None:
    with (
        load(tmp_path, MACHINE).prepare("light") as prepared,
        pytest.raises((HarnessError, UsageError), match=words),
    ):
        prepared.run(start_values=start)


def test_differences_are_those_of_the_experiment(tmp_path: Path) -> None:
    """The prepared runs compared above are runs: they start where they are told to."""
    experiment: Experiment = load(tmp_path, MACHINE)
    with experiment.prepare("light") as prepared:
        result = prepared.run(start_values={"plant": {"speed": -2.0}})
    assert result["plant.speed"][0] == -2.0 and result["plant.angle_deviation"][0] == 0.1
    end = [result[f"plant.{name}"][-1] for name in ("angle_deviation", "speed")]
    assert result.metrics["distance"] == pytest.approx(np.hypot(*end), rel=1e-15)
