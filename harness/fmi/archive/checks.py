"""Judges the members of an FMU archive by its directory, before anything is unpacked.

Each fault is an `FmuError` of one sentence that names the archive and the member. What is judged
here does not depend on the platform: an archive that could be unpacked here but would do harm, or
lose a file, on another system is refused here too.
"""

from __future__ import annotations

import stat
import zipfile
from collections.abc import Iterator, Sequence
from itertools import chain
from operator import attrgetter
from pathlib import Path, PurePosixPath

from harness.errors import FmuError
from harness.fmi.wording import has_control_characters, quoted

DESCRIPTION = "modelDescription.xml"
MAX_DEPTH = 64
ANEW = "pack its files anew as a plain zip archive, or have it exported anew"
"""The way out of an archive that is not unpacked."""

_ENCRYPTED = 0x1
_LOCAL_HEADER = 30
_COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_METHODS = {9: "deflate64", zipfile.ZIP_BZIP2: "bzip2", zipfile.ZIP_LZMA: "lzma", 93: "zstd"}
_KINDS = {
    stat.S_IFLNK: "a symbolic link",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFBLK: "a device file",
    stat.S_IFCHR: "a device file",
}


def check_members(path: Path, members: Sequence[zipfile.ZipInfo]) -> None:
    """Raise `FmuError` for the first member of the archive at `path` that may not be unpacked.

    A member may be there again with the same content, as some tools pack it by mistake.
    """
    for fault in chain(_faults(members), _overlaps(members)):
        raise FmuError(f"FMU {path} {fault}; nothing was unpacked: {ANEW}")


def _faults(members: Sequence[zipfile.ZipInfo]) -> Iterator[str]:
    seen: dict[str, zipfile.ZipInfo] = {}
    for member in members:
        if fault := _name_fault(member) or _content_fault(member):
            yield f"{fault}: {quoted(member.orig_filename)}"
        name = member.filename.rstrip("/")
        first = seen.setdefault(name.casefold(), member)
        if first is not member and not member.is_dir() and not _same(first, member):
            other = first.filename.rstrip("/")
            words = "twice, with other content"
            if other != name:
                words = f"also as {quoted(other)}, told by case only"
            yield f"has the member {quoted(name)} {words}; names must be unique"


def _same(first: zipfile.ZipInfo, second: zipfile.ZipInfo) -> bool:
    """Whether two members have one name and, as far as the directory tells, one content."""
    told = attrgetter("filename", "file_size", "CRC")
    return bool(told(first) == told(second))


def check_root(path: Path, members: Sequence[zipfile.ZipInfo], root: str) -> None:
    """Raise `FmuError` for an archive without its description, saying where one is instead."""
    for member in members:
        place = PurePosixPath(member.filename)
        if place.name.casefold() != root.casefold():
            continue
        if len(place.parts) == 1:
            raise FmuError(f"FMU {path} has no {root} at its root but {place.name!r}; {ANEW}")
        raise FmuError(
            f"FMU {path} has no {root} at its root but in the folder "
            f"{quoted(str(place.parent))}; pack what is in that folder, not the folder"
        )
    raise FmuError(f"FMU {path} has no {root} at its root; give the path of what was exported")


def _name_fault(member: zipfile.ZipInfo) -> str:
    name = member.orig_filename  # zipfile has cut `filename` at a NUL
    if not name or has_control_characters(name):
        return "has a member whose name has control characters or is empty"
    folders = name.replace("\\", "/").split("/")
    if name.startswith("/") or ".." in folders or ":" in folders[0]:
        return "has a member that leaves its folder"
    if "\\" in name:
        return "has a member with backslashes in its name, where the standard demands '/'"
    if len(PurePosixPath(name).parts) > MAX_DEPTH:
        return f"has a member more than {MAX_DEPTH} folders deep"
    return ""


def _content_fault(member: zipfile.ZipInfo) -> str:
    kind = stat.S_IFMT(member.external_attr >> 16)
    if kind in _KINDS:
        return f"has {_KINDS[kind]} as a member"
    if member.flag_bits & _ENCRYPTED:
        return "has a member that is encrypted, which FMUs may not be"
    if member.compress_type not in _COMPRESSIONS:
        method = _METHODS.get(member.compress_type, f"method {member.compress_type}")
        return f"has a member compressed by {method}, where the standard allows deflate only"
    return ""


def _overlaps(members: Sequence[zipfile.ZipInfo]) -> Iterator[str]:
    """Members that share bytes are how a small archive holds a bomb of any size."""
    end, last = 0, ""
    for member in sorted(members, key=attrgetter("header_offset")):
        if member.header_offset < 0:
            yield "cannot be unpacked: its directory points outside of it"
        if member.header_offset < end:
            yield f"has members that overlap: {quoted(last)} and {quoted(member.filename)}"
        end = member.header_offset + _LOCAL_HEADER + member.compress_size
        last = member.filename
