"""Unpacking FMU archives, which are hostile until checked.

An archive is unpacked into a temporary folder that disappears with the `Archive` object or at
interpreter exit. Members with absolute paths, parent references, drive letters or links are
refused, and so are archives that unpack to more than `MAX_BYTES` or `MAX_MEMBERS`.
"""

from __future__ import annotations

import hashlib
import lzma
import shutil
import stat
import weakref
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import ClassVar, Self

from harness.errors import FmuError
from harness.fmi.temporary import make_folder

_BROKEN = (
    zipfile.BadZipFile, zlib.error, lzma.LZMAError, NotImplementedError, RuntimeError, EOFError,
    OSError, UnicodeDecodeError,
)  # fmt: skip
"""What zipfile raises on archives that are cut, garbled, encrypted or otherwise not to be read."""

MAX_BYTES = 4 * 2**30
MAX_MEMBERS = 100_000


class Archive:
    """An unpacked FMU: `folder` holds its files, `sha256` is the hash of the archive."""

    ROOT: ClassVar[str] = "modelDescription.xml"
    """The document at the root without which the archive is none of this kind."""

    def __init__(self, path: Path) -> None:
        """Check and unpack `path`; raises `FmuError` when it is missing, broken or hostile."""
        self.path = Path(path)
        if not self.path.is_file():
            raise FmuError(f"FMU {self.path} is not a file; give the path of an .fmu archive")
        self.sha256 = hashlib.sha256(self.path.read_bytes()).hexdigest()
        self.folder = make_folder()
        self._finalizer = weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        try:
            self._unpack()
        except BaseException:
            self.close()
            raise

    def _unpack(self) -> None:
        try:
            with zipfile.ZipFile(self.path) as archive:
                members = archive.infolist()
                _check_members(self.path, members)
                archive.extractall(self.folder)
        except _BROKEN as fault:
            raise FmuError(f"FMU {self.path} cannot be unpacked: {fault}") from fault
        if not (self.folder / self.ROOT).is_file():
            raise FmuError(f"FMU {self.path} has no {self.ROOT} at its root")

    def close(self) -> None:
        """Remove the unpacked files."""
        self._finalizer()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _check_members(path: Path, members: list[zipfile.ZipInfo]) -> None:
    if len(members) > MAX_MEMBERS:
        raise FmuError(f"FMU {path} has {len(members)} members; at most {MAX_MEMBERS} are unpacked")
    total = sum(member.file_size for member in members)
    if total > MAX_BYTES:
        raise FmuError(f"FMU {path} unpacks to {total} bytes; at most {MAX_BYTES} are unpacked")
    for member in members:
        name = member.filename
        parts = PurePosixPath(name).parts
        if "\\" in name or name.startswith("/") or ".." in parts or (parts and ":" in parts[0]):
            raise FmuError(f"FMU {path} has a member that leaves its folder: {name!r}")
        if stat.S_ISLNK(member.external_attr >> 16):
            raise FmuError(f"FMU {path} has a symbolic link as a member: {name!r}")
