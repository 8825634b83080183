"""System Structure and Parameterization (SSP): systems as other tools read and write them."""

from __future__ import annotations

from pathlib import Path

DEFAULT = "SystemStructure.ssd"


def is_package(path: str | Path) -> bool:
    """Whether that names a package: a `.ssp` or `.ssd` file, or a folder with a description."""
    path = Path(path)
    return path.suffix in (".ssp", ".ssd") or (path / DEFAULT).is_file()
