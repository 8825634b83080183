"""`harness.open` gives a run, a study and a sweep again; a second run into one folder replaces the
first where that is asked for, and is refused else."""

from pathlib import Path

import numpy as np
import pytest

import harness
from harness.bench import Bench
from harness.cli.main import run_command_line
from harness.errors import RecordingError
from harness.experiment.study import Study
from harness.experiment.sweep import Region
from tests.harness.experiment.loops import MACHINE, load, write


def run(path: Path, folder: Path, *flags: str) -> int:
    return run_command_line(["run", str(path), "--output", str(folder), "--jobs", "1", *flags])


def test_a_run_of_a_script_with_its_metrics(tmp_path: Path) -> None:
    experiment = load(tmp_path)
    made = experiment.run("hard", tmp_path / "run")
    (tmp_path / "loops" / "lag.toml").unlink()
    again = harness.open(tmp_path / "run")
    assert isinstance(again, harness.Result) and again.metrics == made.metrics
    assert again.metrics["iae"] and again.manifest.seeds == made.manifest.seeds
    assert np.array_equal(again["lag.y"], made["lag.y"]) and again.plot("lag.y").axes


def test_runs_of_the_command_line(tmp_path: Path) -> None:
    assert run(write(tmp_path), tmp_path / "out") == 0
    found = harness.open(tmp_path / "out")
    assert isinstance(found, dict) and list(found) == ["soft", "hard"]
    assert found["hard"].metrics["iae"] != found["soft"].metrics["iae"]  # type: ignore[union-attr]


def test_a_study_and_a_sweep(tmp_path: Path) -> None:
    assert run(write(tmp_path), tmp_path / "study", "--study") == 0
    study = harness.open(tmp_path / "study")
    assert isinstance(study, Study) and study.complete and len(study.frame()) == 6
    assert study.frame().to_csv(index=False) == (tmp_path / "study" / "study.csv").read_text()
    machine = write(tmp_path, MACHINE)
    assert run(machine, tmp_path / "sweep", "--sweep", "--variant", "light") == 0
    regions = harness.open(tmp_path / "sweep")
    assert isinstance(regions, dict) and isinstance(regions["light"], Region)
    assert regions["light"].outcome.shape == (2, 3) and np.isfinite(regions["light"].outcome).all()


def test_a_second_run_replaces_the_first_where_asked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, folder = write(tmp_path), tmp_path / "out"
    assert run(path, folder) == 0
    (folder / "notes.txt").write_text("mine")
    assert run(path, folder) == 1
    assert "replace it by --overwrite" in capsys.readouterr().err
    assert run(path, folder, "--overwrite", "--variant", "hard", "--set", "stop_time=0.5") == 0
    found = harness.open(folder)
    assert isinstance(found, dict) and list(found) == ["hard"]
    assert found["hard"].time[-1] == 0.5  # type: ignore[union-attr]
    assert (folder / "notes.txt").read_text() == "mine"
    assert not (folder / "soft" / "manifest.json").exists()


@pytest.mark.parametrize("with_fmu", [False, True])
def test_a_script_run_twice(tmp_path: Path, with_fmu: bool) -> None:
    bench = Bench(stop_time=0.2, step=0.1)
    bench.signal("one", "constant", value=1.0)
    if with_fmu:
        bench.fmu("plant", "oscillator_left")
        bench.connect("one", "plant.coupling_force")
    bench.run(tmp_path / "run")
    with pytest.raises(RecordingError, match="replace the run that it holds by overwrite"):
        bench.run(tmp_path / "run")
    bench.stop_time = 0.4
    assert bench.run(tmp_path / "run", overwrite=True).time[-1] == pytest.approx(0.4)
    assert len(harness.open(tmp_path / "run").time) == 5  # type: ignore[union-attr]


def test_files_that_are_no_run_are_never_removed(tmp_path: Path) -> None:
    (tmp_path / "manifest.json").write_text('{"name": "a web page"}')
    bench = Bench(stop_time=0.2, step=0.1)
    bench.signal("one", "constant", value=1.0)
    with pytest.raises(RecordingError, match="is not empty"):
        bench.run(tmp_path, overwrite=True)
    assert "web page" in (tmp_path / "manifest.json").read_text()
    with pytest.raises(RecordingError, match=r"holds no run, study or sweep"):
        harness.open(tmp_path / "nowhere")
