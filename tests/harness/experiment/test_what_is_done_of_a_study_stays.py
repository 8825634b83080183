"""A study or sweep that ends early gives what was done, and goes on to the same figures."""

from collections.abc import Callable
from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from harness.cli.run_record import RunRecord
from harness.errors import HarnessError
from harness.experiment.journal import JOURNAL_FILE, Journal
from harness.experiment.parallel import Workers
from harness.experiment.study import run_study
from harness.experiment.sweep import run_sweep
from harness.results.manifest import read_manifest
from tests.harness.experiment.loops import FILE, MACHINE, load

TEN = FILE.replace("seeds = 3", "seeds = 10")
FAULTY = TEN.replace(
    "[study]", '[variants.faulty]\ncomponents.lag.controller = "tests.no_such:Thing"\n[study]'
)


def interrupted(after: int) -> Callable[[float], None]:
    calls = []

    def progress(share: float) -> None:
        calls.append(share)
        if len(calls) == after:
            raise KeyboardInterrupt

    return progress


@pytest.mark.parametrize("workers", [1, 2])
def test_a_study(tmp_path: Path, workers: int) -> None:
    experiment, path = load(tmp_path, TEN), tmp_path / "study" / JOURNAL_FILE
    with Workers(workers) as crew, pytest.raises(KeyboardInterrupt) as caught:
        run_study(experiment, workers=crew, progress=interrupted(3), journal=Journal(path))
    early = caught.value.result  # type: ignore[attr-defined]
    held = Journal(path)
    held.read()
    n_done = len(held.found)
    assert 3 <= n_done < 20 and len(early.frame()) == n_done and not early.complete
    path.write_text(path.read_text() + '{"variant": "hard", "point": "se')
    study = run_study(experiment, journal=held)
    assert study.complete and study.runs == run_study(experiment).runs
    assert len(path.read_text().splitlines()) == 20


def test_a_sweep(tmp_path: Path) -> None:
    experiment, journal = load(tmp_path, MACHINE), Journal(tmp_path / JOURNAL_FILE)
    with pytest.raises(KeyboardInterrupt) as caught:
        run_sweep(experiment, workers=Workers(1), progress=interrupted(2), journal=journal)
    early = caught.value.result  # type: ignore[attr-defined]
    assert 0 < early["light"].done.sum() < 6 and early["light"].share >= 0.0
    found, whole = run_sweep(experiment, journal=journal), run_sweep(experiment)
    for variant, region in whole.items():
        assert found[variant].outcome.tobytes() == region.outcome.tobytes()


def test_a_faulty_variant_costs_its_own_runs_only(tmp_path: Path) -> None:
    experiment, journal = load(tmp_path, FAULTY), Journal()
    with pytest.raises(HarnessError, match="no_such") as caught:
        run_study(experiment, workers=Workers(1), journal=journal)
    assert caught.value.result.done("soft") > 0


def test_resume_goes_on_with_the_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    experiment, folder = load(tmp_path, TEN), tmp_path / "out"
    record = RunRecord(experiment, experiment.variants, kind="study")
    record.write(folder)
    journal = Journal(folder / JOURNAL_FILE)
    with pytest.raises(KeyboardInterrupt):
        run_study(experiment, workers=Workers(1), progress=interrupted(4), journal=journal)
    assert run_command_line(["resume", str(folder), "--jobs", "1"]) == 0
    assert "runs done" not in capsys.readouterr().out
    run_study(experiment).write(tmp_path / "whole")
    rows, expected = ((f / "study.csv").read_text() for f in (folder, tmp_path / "whole"))
    assert rows == expected
    manifest = read_manifest(folder)
    assert manifest.status.state == "complete" and manifest.seeds == {"seed": 5, "seeds": 10}
    assert len(manifest.experiment["sha256"]) == 64
    assert manifest.experiment["variants"]["hard"]["components"]["controller"]
