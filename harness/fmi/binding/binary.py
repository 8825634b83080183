"""What a shared library was built for, read from its first bytes before it is loaded.

The loader's own words for a library of another machine ("wrong ELF class", "invalid ELF header")
name neither machine; a library that is cut short it maps nevertheless, and the process dies at
the first touch of what is missing. Known are ELF, PE and Mach-O. This module judges only what
says that a library cannot be loaded here; what it does once it is loaded nobody can see from
outside.
"""

from __future__ import annotations

import struct
from pathlib import Path

_ELF_MACHINES = {3: "x86", 8: "mips", 20: "ppc", 21: "ppc64", 22: "s390x", 40: "arm",
                 62: "x86_64", 183: "aarch64", 243: "riscv64", 258: "loongarch64"}  # fmt: skip
_PE_MACHINES = {0x14C: "x86", 0x8664: "x86_64", 0xAA64: "aarch64", 0x1C0: "arm"}
_MACH_MACHINES = {7: "x86", 0x01000007: "x86_64", 12: "arm", 0x0100000C: "aarch64"}
_SHARED = 3  # e_type of a shared object
_LOAD = 1  # p_type of a part that is mapped


def built_for(path: Path) -> str | None:
    """The platform of the library at `path` as in "aarch64-linux", several joined by " and ";
    None where it is no library at all. Raises `OSError`."""
    with path.open("rb") as content:
        head = content.read(4096)
    if head[:4] == b"\x7fELF" and len(head) >= 20:
        (machine,) = struct.unpack_from(_order(head) + "H", head, 18)
        name = _ELF_MACHINES.get(machine, f"machine {machine}")
        return f"{name if machine != 62 or head[4] == 2 else 'x32'}-linux"
    if head[:2] == b"MZ" and len(head) >= 64:
        (place,) = struct.unpack_from("<I", head, 60)
        if head[place : place + 4] != b"PE\0\0" or len(head) < place + 6:
            return "x86-windows"
        (machine,) = struct.unpack_from("<H", head, place + 4)
        return f"{_PE_MACHINES.get(machine, f'machine {machine:#x}')}-windows"
    return _mach(head)


def cut_short(path: Path) -> str:
    """Why an ELF library is not whole, as a phrase, or ""; raises `OSError`."""
    size = path.stat().st_size
    with path.open("rb") as content:
        head = content.read(64)
        if head[:4] != b"\x7fELF":
            return ""
        if len(head) < 64:
            return f"it is cut short after {size} bytes"
        order, wide = _order(head), head[4] == 2
        if struct.unpack_from(order + "H", head, 16)[0] != _SHARED:
            return "it is an ELF file but no shared library"
        start = struct.unpack_from(order + ("Q" if wide else "I"), head, 32 if wide else 28)[0]
        entry, count = struct.unpack_from(order + "HH", head, 54 if wide else 42)
        if start + entry * count > size or entry < (56 if wide else 32):
            return f"it is cut short after {size} bytes"
        content.seek(start)
        table = content.read(entry * count)
    for place in range(0, entry * count, entry):
        (kind,) = struct.unpack_from(order + "I", table, place)
        form = ("Q", 8, 32) if wide else ("I", 4, 16)
        (offset,) = struct.unpack_from(order + form[0], table, place + form[1])
        (length,) = struct.unpack_from(order + form[0], table, place + form[2])
        if kind == _LOAD and offset + length > size:
            return f"it is cut short: {size} of at least {offset + length} bytes are there"
    return ""


def _order(head: bytes) -> str:
    return ">" if head[5] == 2 else "<"


def _mach(head: bytes) -> str | None:
    magic = head[:4]
    if magic in (b"\xcf\xfa\xed\xfe", b"\xce\xfa\xed\xfe") and len(head) >= 8:
        return f"{_mach_name(struct.unpack_from('<I', head, 4)[0])}-darwin"
    if magic == b"\xca\xfe\xba\xbe" and len(head) >= 8:
        (count,) = struct.unpack_from(">I", head, 4)
        if count > 16 or len(head) < 8 + 20 * count:
            return None
        kinds = [struct.unpack_from(">I", head, 8 + 20 * i)[0] for i in range(count)]
        return " and ".join(f"{_mach_name(kind)}-darwin" for kind in kinds)
    return None


def _mach_name(kind: int) -> str:
    return _MACH_MACHINES.get(kind, f"machine {kind:#x}")
