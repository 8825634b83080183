"""Where fuzzed documents are put, and where the committed ones are."""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from functools import cache
from pathlib import Path

CORPUS = Path(__file__).with_name("corpus")


class _Place:
    """A folder in memory that disappears at exit, since disks are slow to be written to."""

    def __init__(self) -> None:
        fast = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
        self.path = Path(tempfile.mkdtemp(prefix="fmu-harness-fuzz-", dir=fast))
        weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)


@cache
def _place() -> _Place:
    return _Place()


def place() -> Path:
    """The folder of this process."""
    return _place().path


def written(name: str, content: bytes) -> Path:
    """A file there."""
    path = place() / name
    path.write_bytes(content)
    return path
