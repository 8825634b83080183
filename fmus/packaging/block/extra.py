"""Files below `extra/` in the FMU of a block, made when the FMU without them is there."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

from fmus.packaging.archive import write_archive

ExtraFiles = Callable[[Path], Mapping[str, bytes]]
"""Gets the path of the FMU without extra files, returns what to add by path below `extra/`."""


def extra_name(extra: ExtraFiles | None) -> str:
    """What stands for `extra` in the key of an FMU."""
    return "" if extra is None else f"{extra.__module__}.{extra.__qualname__}"


def write_with_extra(
    files: Mapping[str, bytes], name: str, extra: ExtraFiles | None, path: Path
) -> None:
    """Write the archive with what `extra` adds to it, below `extra/`."""
    complete = dict(files)
    if extra is not None:
        with tempfile.TemporaryDirectory(prefix="fmu-harness-") as folder:
            plain = Path(folder, f"{name}.fmu")
            write_archive(complete, plain)
            complete |= {f"extra/{key}": data for key, data in extra(plain).items()}
    write_archive(complete, path)
