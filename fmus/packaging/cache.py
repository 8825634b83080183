"""FMUs on disk: built on first use, found again by what they are made of.

The key of an FMU is a hash of all generated files, the compiler and the platform; whatever
changes makes another file. Files appear whole (written aside, then renamed), so two processes may
build at once.
"""

from __future__ import annotations

import hashlib
import os
import stat
import sys
import tempfile
import warnings
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

from fmus.packaging.compiler import Target

_APPLICATION = "fmu-harness"


def cache_directory() -> Path:
    """Where FMUs are kept: `FMU_HARNESS_CACHE`, else the user's cache folder of the platform; where
    nothing can be written there (a read-only home, or none), a folder of the user's among the
    temporary ones, and one note says so."""
    return _writable(_preferred())


def _preferred() -> Path | None:
    if chosen := os.environ.get("FMU_HARNESS_CACHE"):
        return Path(chosen)
    try:
        if sys.platform == "win32":
            base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData/Local")
        elif sys.platform == "darwin":
            base = Path.home() / "Library/Caches"
        else:
            base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    except RuntimeError:  # the user has no home
        return None
    return base / _APPLICATION


@cache
def _writable(preferred: Path | None) -> Path:
    """The folder, if it can be written, else a temporary one."""
    reason = "you have no home"
    if preferred is not None:
        try:
            preferred.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=preferred).close()
            return preferred
        except OSError as fault:
            reason = f"{preferred}: {fault.strerror or fault}"
    made = _temporary()
    warnings.warn(
        f"FMUs cannot be kept ({reason}), so they are built in {made}; set FMU_HARNESS_CACHE to a "
        "folder that can be written",
        stacklevel=3,
    )
    return made


def _temporary() -> Path:
    """A temporary folder that nobody else can write: FMUs in it are run."""
    if not hasattr(os, "getuid"):
        return Path(tempfile.gettempdir()) / _APPLICATION
    found = Path(tempfile.gettempdir()) / f"{_APPLICATION}-{os.getuid()}"
    found.mkdir(mode=0o700, exist_ok=True)
    about = found.lstat()
    if stat.S_ISDIR(about.st_mode) and about.st_uid == os.getuid() and not about.st_mode & 0o022:
        return found
    return Path(tempfile.mkdtemp(prefix=f"{_APPLICATION}-"))


def made_by(targets: Sequence[Target]) -> str:
    """What decides binaries besides their sources, as part of a key."""
    return "; ".join(target.identity for target in targets)


def place(name: str, content: str, maker: str) -> Path:
    """Where the FMU with this hash of its content, made by `maker`, is kept."""
    key = hashlib.sha256(f"{content} {maker}".encode()).hexdigest()[:16]
    return kept(f"{key}/{name}.fmu")


def kept(relative: str) -> Path:
    """A file of the cache: where it is there already, else where it can be written."""
    preferred = _preferred()
    if preferred is not None and (preferred / relative).exists():
        return preferred / relative
    return cache_directory() / relative


def write_atomically(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill a file beside `path`, then rename it; nothing is left when it fails."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".part-", dir=path.parent) as folder:
        part = Path(folder) / path.name
        write(part)
        part.replace(path)
