"""FMUs on disk: built on first use, found again by what they are made of.

The key of an FMU is a hash of all generated files, the compiler and the platform; whatever
changes makes another file. Files appear whole (written aside, then renamed), so two processes may
build at once.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from fmus.packaging.compiler import Target

_APPLICATION = "fmu-harness"


def cache_directory() -> Path:
    """Where FMUs are kept: `FMU_HARNESS_CACHE`, else the user's cache folder of the platform."""
    if chosen := os.environ.get("FMU_HARNESS_CACHE"):
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData/Local") / _APPLICATION
    if sys.platform == "darwin":
        return Path.home() / "Library/Caches" / _APPLICATION
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / _APPLICATION


def made_by(targets: Sequence[Target]) -> str:
    """What decides binaries besides their sources, as part of a key."""
    return "; ".join(target.identity for target in targets)


def place(name: str, content: str, maker: str) -> Path:
    """Where the FMU with this hash of its content, made by `maker`, is kept."""
    key = hashlib.sha256(f"{content} {maker}".encode()).hexdigest()[:16]
    return cache_directory() / key / f"{name}.fmu"


def write_atomically(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill a file beside `path`, then rename it; nothing is left when it fails."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".part-", dir=path.parent) as folder:
        part = Path(folder) / path.name
        write(part)
        part.replace(path)
