"""`--isolate`: an FMU cannot write where it likes, and the run gives what it gives otherwise."""

from pathlib import Path

import numpy as np
import pytest

from harness.bench import Bench
from harness.cli.main import run_command_line
from harness.errors import ExperimentError, UsageError
from harness.experiment.experiment import Experiment
from harness.process.isolation import missing
from harness.process.limits import Limits
from harness.results.storage import read_recording
from tests.hostile.build import hostile_fmu
from tests.hostile.test_runs_end_in_one_sentence import FILE

pytestmark = pytest.mark.skipif(bool(missing()), reason="; ".join(missing()))


def run(folder: Path, *more: str) -> tuple[int, Path]:
    (folder / "lag.toml").write_text(FILE.replace("call = 0.3", ""))
    out = folder / f"out{len(more)}"
    code = run_command_line(["run", str(folder / "lag.toml"), "--output", str(out), *more])
    return code, out / "run"


def test_the_fmus_litter_is_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    hostile_fmu(tmp_path, "DoStep litter 5")
    free, fenced = run(tmp_path), run(tmp_path, "--isolate")
    assert (free[0], fenced[0]) == (0, 0)
    assert np.array_equal(read_recording(free[1]).data, read_recording(fenced[1]).data)
    assert (tmp_path / "litter.txt").exists()
    (tmp_path / "litter.txt").unlink()
    assert run(tmp_path, "--isolate", "--fmi-logging")[0] == 0
    assert not (tmp_path / "litter.txt").exists()


def test_memory_ends_at_the_limit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    hostile_fmu(tmp_path, "DoStep memory 5")
    code, _ = run(tmp_path, "--isolate", "--memory-limit", "500 MiB")
    error = capsys.readouterr().err
    assert code == 1 and ("SIGABRT" in error or "more than its limit of 500 MiB" in error)


def test_without_a_worker_it_is_refused(tmp_path: Path) -> None:
    bench = Bench(stop_time=0.1)
    bench.fmu("plant", hostile_fmu(tmp_path))
    with pytest.raises(UsageError, match="isolation needs a worker process"):
        bench.run(in_process=True, limits=Limits(isolate=True))


def test_many_runs_in_one_worker_refuse_it(tmp_path: Path) -> None:
    hostile_fmu(tmp_path)
    (tmp_path / "lag.toml").write_text(FILE + "isolate = true\n")
    with pytest.raises(ExperimentError, match=r"key limits\.isolate: studies and sweeps run many"):
        Experiment.load(tmp_path / "lag.toml").prepare("run")
