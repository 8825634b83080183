"""What a Mach-O library (64 bits, little endian) offers and asks for, from its symbol table."""

from __future__ import annotations

import struct
from dataclasses import dataclass

_MAGIC, _SYMTAB, _LOAD_DYLIB, _BUILD_VERSION = 0xFEEDFACF, 0x2, 0xC, 0x32
_CPU = {0x01000007: "x86_64", 0x0100000C: "aarch64"}
_DEFINED_AND_EXTERNAL, _EXTERNAL, _PRIVATE, _DEBUG = 0x0F, 0x01, 0x10, 0xE0


@dataclass(frozen=True)
class MachO:
    """`macos` is the least version that it runs on."""

    cpu: str
    exported: frozenset[str]
    undefined: frozenset[str]
    libraries: tuple[str, ...]
    macos: str


def read(data: bytes) -> MachO:
    """Parse a library; the field names are those of mach-o/loader.h and nlist.h."""
    magic, cpu, _, _, ncmds, _, _, _ = struct.unpack_from("<8I", data)
    assert magic == _MAGIC
    exported, undefined, libraries, macos = set(), set(), [], ""
    offset = 32
    for _ in range(ncmds):
        cmd, cmdsize = struct.unpack_from("<2I", data, offset)
        if cmd & 0xFF == _LOAD_DYLIB:
            (name,) = struct.unpack_from("<I", data, offset + 8)
            libraries.append(_text(data, offset + name))
        elif cmd == _BUILD_VERSION:
            (minos,) = struct.unpack_from("<I", data, offset + 12)
            macos = f"{minos >> 16}.{minos >> 8 & 0xFF}"
        elif cmd == _SYMTAB:
            symoff, nsyms, stroff, _ = struct.unpack_from("<4I", data, offset + 8)
            for i in range(nsyms):
                strx, kind, _, _, _ = struct.unpack_from("<IBBHQ", data, symoff + 16 * i)
                name = _text(data, stroff + strx)
                if kind & _DEBUG or kind & _PRIVATE or not kind & _EXTERNAL:
                    continue
                defined = kind & _DEFINED_AND_EXTERNAL == _DEFINED_AND_EXTERNAL
                (exported if defined else undefined).add(name)
        offset += cmdsize
    return MachO(_CPU[cpu], frozenset(exported), frozenset(undefined), tuple(libraries), macos)


def _text(data: bytes, offset: int) -> str:
    return data[offset : data.index(b"\0", offset)].decode()
