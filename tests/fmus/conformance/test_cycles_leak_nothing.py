"""Hundreds of lives of an instance leave no memory, no file and no library behind."""

import ctypes
import gc
import os
import sys
from pathlib import Path

import pytest

from tests.fmus.conformance.stored_run import restore, serialized
from tests.fmus.packaging.instances import Instance, load

CYCLES = 200
RESIDENT_BYTES = 1_000_000  # the interpreter's own growth; an instance of some kB each would show
ALLOCATED_BYTES = 50_000  # a twentieth of what a stored state of 1 kB each would leave

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="reads memory and open files from Linux's /proc"
)


class MallocInfo(ctypes.Structure):
    """glibc's struct mallinfo2: ten numbers, `in_use` (uordblks) the bytes given out."""

    _fields_ = (
        ("_before", ctypes.c_size_t * 7),
        ("in_use", ctypes.c_size_t),
        ("_after", ctypes.c_size_t * 2),
    )


def allocated_bytes() -> int:
    """Bytes that malloc has given out; 0 where the C library does not say."""
    function = getattr(ctypes.CDLL(None), "mallinfo2", None)
    if function is None:
        return 0
    function.restype = MallocInfo
    gc.collect()
    return int(function().in_use)


def resident_bytes() -> int:
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def open_files() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


def mapped(folder: Path) -> list[str]:
    maps = Path("/proc/self/maps").read_text()
    return [line for line in maps.splitlines() if str(folder) in line]


def life(instance: Instance) -> None:
    """Everything that allocates: instance, states, bytes, a step, a message, the end."""
    instance.instantiate(logging=True)
    instance.initialize()
    for k in range(3):
        instance.step(k, 0.01)
    restore(instance, serialized(instance))
    instance.step(3, 0.01)
    instance.messages.clear()
    instance.fmu.terminate()


def test_instances_of_a_loaded_library(fmu: Path, version: int, tmp_path: Path) -> None:
    instance = load(fmu, tmp_path)
    free = getattr(instance.fmu, f"fmi{version}FreeInstance")

    def lives(n: int) -> None:
        for _ in range(n):
            life(instance)
            free(instance.fmu.component)

    lives(CYCLES)
    before = allocated_bytes(), resident_bytes(), open_files()
    lives(5 * CYCLES)
    after = allocated_bytes(), resident_bytes(), open_files()
    instance.fmu.freeLibrary()
    assert after[0] - before[0] <= ALLOCATED_BYTES
    assert after[1] - before[1] <= RESIDENT_BYTES
    assert after[2] == before[2]


def test_library_loaded_and_unloaded(fmu: Path, tmp_path: Path) -> None:
    """Nothing stays open, mapped or written."""
    before = open_files()
    for cycle in range(CYCLES // 5):
        folder = tmp_path / str(cycle)
        instance = load(fmu, folder)
        shipped = sorted(path for path in folder.rglob("*"))
        life(instance)
        instance.fmu.freeInstance()
        assert sorted(path for path in folder.rglob("*")) == shipped
    assert mapped(tmp_path) == []
    assert open_files() == before
