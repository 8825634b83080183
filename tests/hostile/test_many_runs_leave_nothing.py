"""Short runs one after another: memory, descriptors and temporary files stay as they are."""

import gc
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

from harness.bench import Bench
from tests.hostile.build import hostile_fmu, library


def held() -> int:
    """Bytes of memory that this process holds."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def descriptors() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


def repeat(folder: Path, behaviour: str, in_process: bool) -> Callable[[], None]:
    path = hostile_fmu(folder, behaviour)

    def one() -> None:
        bench = Bench(stop_time=0.05)
        bench.fmu("plant", path)
        bench.signal("reference", "step", time=0.02, final=1.0)
        bench.connect("reference.value", "plant.u")
        result = bench.run(in_process=in_process)
        assert len(result.time) == 6

    return one


def stay_flat(one: Callable[[], None], warm: int, count: int, growth: int) -> None:
    """What leaks grows in every round; what malloc takes once for all, in a process that has much
    already, grows in one."""
    for _ in range(warm):
        one()
    more = []
    while len(more) < 3 and (not more or more[-1] >= growth):
        memory, open_files = held(), descriptors()
        for _ in range(count):
            one()
        assert descriptors() == open_files
        more.append(held() - memory)
    assert more[-1] < growth, f"{more} bytes more in rounds of {count} runs"


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    library(3)  # has a temporary folder of its own
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.mark.parametrize(("in_process", "count"), [(True, 200), (False, 40)])
def test_some_runs(tmp_path: Path, temporary: Path, in_process: bool, count: int) -> None:
    stay_flat(repeat(tmp_path, "DoStep log_many 0 10", in_process), 20, count, 2_000_000)
    assert list(temporary.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize(("in_process", "count"), [(True, 10_000), (False, 500)])
def test_very_many_runs(tmp_path: Path, temporary: Path, in_process: bool, count: int) -> None:
    """What malloc keeps of any number of runs is about 3 MB; an instance, a library or a
    description of each that stayed would be more."""
    stay_flat(repeat(tmp_path, "DoStep log 2", in_process), 200, count, 5_000_000)
    assert list(temporary.iterdir()) == []
