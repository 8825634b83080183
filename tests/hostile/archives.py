"""Hostile archives, written byte by byte where zipfile would refuse to write them."""

import io
import random
import stat
import struct
import zipfile
from collections.abc import Callable

XML = b"<fmiModelDescription/>"
Member = tuple[str | zipfile.ZipInfo, bytes]


def packed(*members: Member, description: str | None = "modelDescription.xml") -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        if description is not None:
            archive.writestr(description, XML)
        for name, content in members:
            archive.writestr(name, content)
    return buffer.getvalue()


def special(name: str, kind: int) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name)
    info.create_system, info.external_attr = 3, (kind | 0o777) << 16
    return info


def renamed(name: str) -> bytes:
    """A member called `name`, which zipfile itself would change or refuse."""
    stand_in = "N" * len(name)
    return packed((stand_in, b"x")).replace(stand_in.encode(), name.encode())


def repeated(first: str, second: str) -> bytes:
    """Two members whose names have equal length, written under one and then renamed."""
    stand_in = "N" * len(second)
    return packed((first, b"1"), (stand_in, b"2")).replace(stand_in.encode(), second.encode())


def changed(content: bytes, signature: bytes, offset: int, form: str, value: int) -> bytes:
    """`content` with a field of the last record that starts with `signature` overwritten."""
    place = content.rindex(signature) + offset
    size = struct.calcsize(form)
    return content[:place] + struct.pack(form, value) + content[place + size :]


CENTRAL, LOCAL, END = b"PK\x01\x02", b"PK\x03\x04", b"PK\x05\x06"


def overlapping() -> bytes:
    """The last directory entry points at the member before it."""
    content = packed(("first", b"1" * 50), ("second", b"2" * 50))
    before = content.index(LOCAL, content.index(LOCAL) + 4)
    return changed(content, CENTRAL, 42, "<L", before + 3)


def with_size(declared: int) -> bytes:
    content = packed(("data", b"a" * 1000))
    content = changed(content, CENTRAL, 24, "<L", declared)
    return changed(content, LOCAL, 22, "<L", declared)


def garbled() -> bytes:
    good = packed(("data", bytes(random.Random(1).choices(b"abcdefgh   ", k=5000))))
    middle = good.index(b"data") + 300
    return good[:middle] + bytes(b ^ 0xFF for b in good[middle : middle + 60]) + good[middle + 60 :]


def compressed(method: int) -> bytes:
    info = zipfile.ZipInfo("data")
    info.compress_type = method
    return packed((info, b"a" * 100))


ARCHIVES: dict[str, tuple[Callable[[], bytes], str]] = {
    "parent": (lambda: packed(("../evil", b"x")), "leaves its folder"),
    "parent inside": (lambda: packed(("a/../../evil", b"x")), "leaves its folder"),
    "parent only": (lambda: packed(("..", b"x")), "leaves its folder"),
    "absolute": (lambda: packed(("/etc/evil", b"x")), "leaves its folder"),
    "drive": (lambda: packed(("c:/evil", b"x")), "leaves its folder"),
    "parent with backslashes": (lambda: renamed("a\\..\\..\\evil"), "leaves its folder"),
    "backslash": (lambda: renamed("resources\\data"), "backslashes in its name"),
    "NUL in a name": (lambda: renamed("a\0b"), "control characters"),
    "line feed in a name": (lambda: renamed("a\nb"), "control characters"),
    "deep folders": (lambda: packed(("a/" * 1000 + "b", b"x")), "more than 64 folders deep"),
    "long name": (lambda: packed(("a" * 5000, b"x")), "cannot be unpacked: .* too long"),
    "link": (lambda: packed((special("l", stat.S_IFLNK), b"/etc/passwd")), "a symbolic link"),
    "device": (lambda: packed((special("d", stat.S_IFCHR), b"")), "a device file"),
    "pipe": (lambda: packed((special("p", stat.S_IFIFO), b"")), "a named pipe"),
    "socket": (lambda: packed((special("s", stat.S_IFSOCK), b"")), "a socket"),
    "encrypted": (
        lambda: changed(packed(("data", b"x")), CENTRAL, 8, "<H", 1), "encrypted, which FMUs"
    ),
    "bzip2": (lambda: compressed(zipfile.ZIP_BZIP2), "compressed by bzip2"),
    "lzma": (lambda: compressed(zipfile.ZIP_LZMA), "compressed by lzma"),
    "unknown method": (
        lambda: changed(packed(("data", b"x")), CENTRAL, 10, "<H", 99), "compressed by method 99"
    ),
    "twice": (lambda: repeated("name", "name"), "'name' twice"),
    "description twice": (
        lambda: repeated("b", "modelDescription.xml"), "'modelDescription.xml' twice"
    ),
    "only case tells": (lambda: repeated("Name", "name"), "also as 'Name', told by case"),
    "file and folder": (lambda: packed(("a", b"1"), ("a/b", b"2")), "cannot be unpacked"),
    "overlapping": (overlapping, "overlap: 'first' and 'second'"),
    "more than declared": (lambda: with_size(10), "cannot be unpacked"),
    "less than declared": (lambda: with_size(5000), "cannot be unpacked"),
    "zeros": (lambda: packed(("zeros", bytes(200_000))), "unpacks to 200022 bytes; at most"),
    "ratio": (lambda: packed(("zeros", bytes(90_000))), "taken for a bomb"),
    "claims 4 GB": (lambda: with_size(2**32 - 2), "unpacks to 4294967316 bytes; at most"),
    "many": (lambda: packed(*((f"m{i}", b"") for i in range(60))), "has 61 members; at most"),
    "wrong checksum": (
        lambda: changed(packed(("data", b"x")), CENTRAL, 16, "<L", 7), "cannot be unpacked: Bad CRC"
    ),
    "offset outside": (
        lambda: changed(packed(("data", b"x")), CENTRAL, 42, "<L", 2**31), "cannot be unpacked"
    ),
    "directory outside": (
        lambda: changed(packed(("data", b"x")), END, 16, "<L", 2**31), "cannot be unpacked"
    ),
    "text": (lambda: b"no archive at all", "cannot be unpacked: File is not a zip file"),
    "empty": (lambda: b"", "cannot be unpacked"),
    "start only": (lambda: packed(("data", b"x"))[:60], "cannot be unpacked"),
    "end cut": (lambda: packed(("data", b"x"))[:-10], "cannot be unpacked"),
    "garbled": (garbled, "cannot be unpacked"),
    "name of no text": (
        lambda: packed(("data", b"x")).replace(b"data", b"d\xff\xfe\xfd"), "unpacked|no fmiVersion"
    ),
    "no members": (lambda: packed(description=None), "no modelDescription.xml at its root"),
    "wrong case": (
        lambda: packed(description="ModelDescription.xml"), "root but 'ModelDescription.xml'"
    ),
    "in a folder": (
        lambda: packed(description="plant/modelDescription.xml"), "in the folder 'plant'; pack what"
    ),
    "description is a folder": (
        lambda: packed(description="modelDescription.xml/"), "no modelDescription.xml at its root"
    ),
    "zip in a zip": (
        lambda: packed(("inner.fmu", packed()), description=None), "no modelDescription.xml"
    ),
}  # fmt: skip
