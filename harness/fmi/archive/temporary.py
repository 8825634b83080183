"""Temporary folders that go away, also after a crash.

Each is called "fmu-harness-PID-…". Making the first one in a process sweeps away those whose
process is dead, so that what a crash leaves behind lives until the next start only.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

PREFIX = "fmu-harness-"
_NAME = re.compile(rf"{PREFIX}(\d+)-\w+")


def make_folder() -> Path:
    """A new folder that carries the number of this process; raises `OSError`."""
    parent = tempfile.gettempdir()
    _sweep_once(parent)
    return Path(tempfile.mkdtemp(prefix=f"{PREFIX}{os.getpid()}-"))


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """The same while open; also the next start removes it, should this process be killed."""
    path = make_folder()
    try:
        yield path
    finally:
        shutil.rmtree(path, ignore_errors=True)


@cache
def _sweep_once(parent: str) -> None:
    sweep(Path(parent))


def sweep(parent: Path) -> list[Path]:
    """Remove the folders below `parent` whose processes are dead; what was removed. Folders of
    other users, and anything that is no folder of ours, stay."""
    removed = []
    for path in parent.glob(f"{PREFIX}*"):
        match = _NAME.fullmatch(path.name)
        if match is None or path.is_symlink() or not path.is_dir() or _alive(int(match[1])):
            continue
        if hasattr(os, "getuid") and path.stat().st_uid != os.getuid():
            continue
        shutil.rmtree(path, ignore_errors=True)
        removed.append(path)
    return removed


def _alive(pid: int) -> bool:
    if sys.platform == "win32":
        import ctypes

        limited_information = 0x1000
        handle = ctypes.windll.kernel32.OpenProcess(limited_information, False, pid)
        if handle:
            ctypes.windll.kernel32.CloseHandle(handle)
        return bool(handle)
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    return True
