"""Files that are written whole or not at all, so that a full disk costs no older file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from harness.errors import RecordingError

ANOTHER_FOLDER = "; choose another one"


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


@contextmanager
def writing(what: str, folder: Path | None = None, *, way_out: str = "") -> Iterator[None]:
    """Makes `folder`, if one is given. An `OSError` while open becomes a `RecordingError`: `what`,
    why, and a `way_out`."""
    try:
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
        yield
    except OSError as fault:
        raise RecordingError(f"{what}: {fault.strerror or fault}{way_out}") from fault


def check_writable(folder: Path) -> None:
    """Raises `RecordingError` where nothing can be written into `folder`, or it cannot be made;
    leaves all as it was. Asked before long work, whose results go there."""
    missing = [one for one in (folder, *folder.parents) if not one.exists()]
    probe = folder / ".fmu-harness.probe"
    with writing(f"cannot make the run folder {folder}", folder, way_out=ANOTHER_FOLDER):
        probe.touch()
        probe.unlink()
        for one in missing:
            one.rmdir()
