"""A run that was ended early and resumed has the rows and files of one that was not, bit by bit."""

from pathlib import Path

import numpy as np
import pytest

from harness.bench import Bench
from harness.errors import HarnessError, RecordingError, SimulationError
from harness.process.checkpoint import CHECKPOINT_FILE
from harness.process.limits import Limits
from harness.results.recording import read_recording
from tests.hostile.worlds import bench

OFTEN = Limits(checkpoint=1e-6)  # after every chunk
FILES = ("results.parquet", "results.csv")


class EnoughError(Exception):
    pass


def same(one: Path, other: Path) -> bool:
    return all((one / name).read_bytes() == (other / name).read_bytes() for name in FILES)


@pytest.mark.parametrize("fmi", [2, 3])
def test_after_a_crash(tmp_path: Path, fmi: int) -> None:
    bench(tmp_path, stop_time=100.0, fmi=fmi).run(tmp_path / "whole")
    broken = bench(tmp_path, "DoStep segfault 7000", stop_time=100.0, fmi=fmi)
    with pytest.raises(SimulationError, match="crashed with SIGSEGV") as caught:
        broken.run(tmp_path / "run", limits=OFTEN)
    rows, kept = len(caught.value.result.time), read_recording(tmp_path / "run")
    assert rows == len(kept.time) == 7001
    assert (tmp_path / "run" / CHECKPOINT_FILE).exists()
    sound = bench(tmp_path, stop_time=100.0, fmi=fmi)
    with pytest.raises(HarnessError, match="is not what it was: FMU of plant changed"):
        sound.run(tmp_path / "run", resume=True)
    assert np.array_equal(read_recording(tmp_path / "run").data, kept.data)


def interrupted(folder: Path, fmi: int = 3) -> Bench:
    """A run in `folder` whose caller ended it, at a place that is not known."""

    def enough(share: float) -> None:
        if share > 0.3 and (folder / "run" / CHECKPOINT_FILE).exists():
            raise EnoughError

    made = bench(folder, "DoStep sleep 1000 1", stop_time=12.0, fmi=fmi)
    with pytest.raises(EnoughError):
        made.run(folder / "run", limits=OFTEN, progress=enough)
    return made


@pytest.mark.parametrize("fmi", [2, 3])
def test_after_its_caller_has_ended_it(tmp_path: Path, fmi: int) -> None:
    made = interrupted(tmp_path, fmi)
    assert (tmp_path / "run" / CHECKPOINT_FILE).exists()
    result = made.run(tmp_path / "run", resume=True)
    made.run(tmp_path / "whole")
    assert result.status.state == "complete" and same(tmp_path / "run", tmp_path / "whole")
    assert {p.name for p in (tmp_path / "run").iterdir()} == {*FILES, "manifest.json"}


def test_another_seed_is_another_run(tmp_path: Path) -> None:
    made = interrupted(tmp_path)
    made.seed += 1
    with pytest.raises(HarnessError, match="not what it was: algorithm and seed changed"):
        made.run(tmp_path / "run", resume=True)


def test_a_damaged_checkpoint_is_told(tmp_path: Path) -> None:
    made = interrupted(tmp_path)
    path = tmp_path / "run" / CHECKPOINT_FILE
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(RecordingError, match="the checkpoint is damaged"):
        made.run(tmp_path / "run", resume=True)


def test_what_cannot_be_resumed_is_closed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An interrupted run leaves a long stream as it is; who wants to go on gets files of it."""
    monkeypatch.setattr("harness.results.recording._QUICK_BYTES", 0)

    def interrupt(share: float) -> None:
        if share > 0.3:
            raise KeyboardInterrupt

    made = bench(tmp_path, "DoStep sleep 0 1", stop_time=2.0)
    made.controller("python", lambda time: time)
    with pytest.raises(KeyboardInterrupt, match="interrupted by Ctrl-C at t = "):
        made.run(tmp_path / "run", progress=interrupt)
    assert {p.name for p in (tmp_path / "run").iterdir()} == {"rows.arrows", "manifest.json"}
    kept = read_recording(tmp_path / "run")
    with pytest.raises(RecordingError, match="its rows so far are in results"):
        made.run(tmp_path / "run", resume=True)
    assert {p.name for p in (tmp_path / "run").iterdir()} == {*FILES, "manifest.json"}
    assert np.array_equal(read_recording(tmp_path / "run").data, kept.data) and len(kept.time) > 50


def test_what_cannot_be_resumed_says_why(tmp_path: Path) -> None:
    made = bench(tmp_path, "DoStep abort 50")
    made.controller("python", lambda time: time)
    with pytest.raises(SimulationError):
        made.run(tmp_path / "run")
    with pytest.raises(RecordingError, match="component python is plain Python, whose state"):
        made.run(tmp_path / "run", resume=True)
    done = bench(tmp_path)
    done.run(tmp_path / "done")
    with pytest.raises(RecordingError, match="complete; there is nothing to resume"):
        done.run(tmp_path / "done", resume=True)
