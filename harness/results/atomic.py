"""Files that are written whole or not at all, so that a full disk costs no older file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from harness.errors import RecordingError


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to, of the same suffix; on leaving it takes the place of
    `path`. Where something goes wrong, what was at `path` stays as it was."""
    partial = path.with_name(f".{path.stem}.partial{path.suffix}")
    try:
        yield partial
        partial.replace(path)
    except BaseException:
        with suppress(OSError):
            partial.unlink(missing_ok=True)
        raise


def check_free(folder: Path, name: str) -> None:
    """Make `folder` where it is missing; raises `RecordingError` where that cannot be, or where it
    holds a `name` already. Asked before long work, whose results go there."""
    path, probe = folder / name, folder / f".{name}.probe"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except OSError as fault:
        raise RecordingError(
            f"cannot write into the folder {folder}: {fault.strerror or fault}; choose another one"
        ) from fault
    if path.exists():
        raise RecordingError(
            f"the folder {folder} holds a {name} already; nothing was changed in it: choose "
            "another folder"
        )
