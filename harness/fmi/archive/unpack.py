"""Unpacking FMU archives, which are hostile until checked.

An archive is unpacked into a temporary folder that disappears with the `Archive` object or at
interpreter exit. Before a byte is written all members are judged by `check_members`; while they
are written, their actual bytes are counted, whatever sizes the archive declares.

This module refuses what no FMU needs: members outside the folder, links and devices, passwords,
compression other than deflate, members that overlap or share a name, and archives that unpack to
more than the limits below. It restores neither permissions nor owners nor times.
"""

from __future__ import annotations

import hashlib
import shutil
import struct
import weakref
import zipfile
import zlib
from pathlib import Path
from typing import Self

from harness.errors import FmuError
from harness.fmi.archive.checks import ANEW, DESCRIPTION, check_members, check_root
from harness.fmi.archive.temporary import make_folder
from harness.fmi.wording import shorten

_BROKEN = (
    zipfile.BadZipFile, zlib.error, struct.error, NotImplementedError, RuntimeError, EOFError,
    OSError, ValueError, IndexError, OverflowError,
)  # fmt: skip
"""What zipfile raises on archives that are cut, garbled or otherwise not to be read."""

MAX_BYTES = 4 * 2**30
MAX_MEMBERS = 100_000
MAX_RATIO = 200
RATIO_FREE_BYTES = 64 * 2**20
"""Archives that unpack to less than this are no bombs, however well they are compressed."""

_PIECE = 2**18


class Archive:
    """An unpacked FMU: `folder` holds its files, `sha256` is the hash of the archive."""

    def __init__(self, path: Path, root: str = DESCRIPTION) -> None:
        """Check and unpack `path`, which must hold the document `root`; raises `FmuError` when it
        is missing, broken or hostile."""
        self.path = path
        self.sha256 = _hash(self.path)
        try:
            self.folder = make_folder()
        except OSError as fault:
            raise FmuError(
                f"FMU {self.path}: no folder to unpack it into: {fault}; make room, or set TMPDIR "
                "to another"
            ) from fault
        self._finalizer = weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        try:
            self._unpack(root)
        except BaseException:
            self.close()
            raise

    def _unpack(self, root: str) -> None:
        try:
            with zipfile.ZipFile(self.path) as archive:
                members = archive.infolist()
                self._check_size(members)
                check_members(self.path, members)
                left = MAX_BYTES
                self._made: set[str] = set()  # asking the file system takes longer than writing
                for member in members:
                    left -= self._extract(archive, member, left)
        except _BROKEN as fault:
            told = f"FMU {self.path} cannot be unpacked: {_reason(fault)}"
            raise FmuError(f"{told}; {_way_out(self.path)}") from fault
        if not (self.folder / root).is_file():
            check_root(self.path, members, root)

    def _check_size(self, members: list[zipfile.ZipInfo]) -> None:
        total = sum(member.file_size for member in members)
        packed = self.path.stat().st_size
        fault = ""
        if len(members) > MAX_MEMBERS:
            fault = f"has {len(members)} members; at most {MAX_MEMBERS} are unpacked"
        elif total > MAX_BYTES:
            fault = f"unpacks to {total} bytes; at most {MAX_BYTES} are unpacked"
        elif total > RATIO_FREE_BYTES and total > MAX_RATIO * packed:
            fault = f"unpacks from {packed} to {total} bytes; more than {MAX_RATIO} times its size "
            fault += "is taken for a bomb"
        if fault:
            way_out = "leave out what is not needed, such as binaries for other platforms"
            raise FmuError(f"FMU {self.path} {fault}; {way_out}")

    def _extract(self, archive: zipfile.ZipFile, member: zipfile.ZipInfo, left: int) -> int:
        """Write one member, or compare one that is there again; its number of bytes, which may
        not exceed `left`."""
        target = "/".join([str(self.folder), *filter(None, member.filename.split("/"))])
        folder = target if member.is_dir() else target.rpartition("/")[0]
        if folder not in self._made:
            Path(folder).mkdir(parents=True, exist_ok=True)
        written, again = 0, target in self._made
        self._made |= {folder, target}
        if member.is_dir():
            return 0
        with archive.open(member) as source, Path(target).open("rb" if again else "xb") as made:
            while piece := source.read(_PIECE):
                written += len(piece)
                if written > min(left, member.file_size):
                    raise zipfile.BadZipFile(f"member {member.filename!r} is larger than declared")
                if not again:
                    made.write(piece)
                elif made.read(len(piece)) != piece:
                    raise zipfile.BadZipFile(f"member {member.filename!r} is there twice")
        if written != member.file_size:
            raise zipfile.BadZipFile(
                f"member {member.filename!r} declares {member.file_size} bytes but has {written}"
            )
        return written

    def close(self) -> None:
        """Remove the unpacked files."""
        self._finalizer()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _hash(path: Path) -> str:
    """The SHA-256 of the file at `path`; raises `FmuError` where there is no such file."""
    try:
        if path.is_dir():
            raise FmuError(
                f"FMU {path} is not a file but a folder; pack what is in it as a zip archive "
                "called .fmu"
            )
        if not path.is_file():
            kind = "an .ssp" if path.suffix == ".ssp" else "an .fmu"
            raise FmuError(f"FMU {path} is not a file; give the path of {kind} archive")
        with path.open("rb") as content:
            return hashlib.file_digest(content, "sha256").hexdigest()
    except OSError as fault:
        told = f"FMU {path} cannot be read: {fault.strerror or fault}"
        raise FmuError(f"{told}; give the path of a file that you may read") from fault


def _way_out(path: Path) -> str:
    """What to do about a file that is no whole zip archive, by what it begins with."""
    with path.open("rb") as content:
        head = content.read(100)
    if head.startswith(b"version https://git-lfs"):
        return "it is a pointer of Git LFS: `git lfs pull` brings the file itself"
    if head.lstrip().lower().startswith((b"<!doctype html", b"<html")):
        return "it is a web page: download the file itself"
    if not head.startswith(b"PK"):
        return "an FMU is a zip archive: give the path of what was exported"
    return f"{ANEW} (or download it again)"


def _reason(fault: BaseException) -> str:
    if isinstance(fault, EOFError):
        return "it is cut short"
    text = fault.strerror if isinstance(fault, OSError) and fault.strerror else str(fault)
    return shorten(text, 200) or type(fault).__name__
