"""Shared libraries that an FMU's library needs and brings along, in its binaries or resources.

The system's loader looks for them where it is told to look, which is seldom inside an FMU. Here a
library that cannot be loaded for want of another one is given that one first, from the folders of
the FMU, with its symbols visible to all. Where the dependency has no soname, or is named by a path,
that does not satisfy Linux' loader; then the entry is struck out in the unpacked copy. On Windows
the folders are offered to the loader instead. Neither the working directory nor the environment is
changed, and nothing outside the FMU's folder is loaded or written.
"""

from __future__ import annotations

import ctypes
import os
import re
import struct
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

_MISSING = re.compile(
    r"([^\s:]+): cannot open shared object file|Library not loaded: (?:@\w+/)?(\S+)"
)
_MOST = 100
_DT_NEEDED, _DT_STRTAB, _IGNORED = 1, 5, 0x6FFFFEF4
_PT_LOAD, _PT_DYNAMIC = 1, 2


def load_with_neighbours(path: Path, root: Path) -> tuple[ctypes.CDLL, list[ctypes.CDLL]]:
    """The library at `path` and those that had to be loaded before it, all below `root`; raises
    `OSError` with the loader's reason where that does not help."""
    first: list[ctypes.CDLL] = []
    with _offered(path, root):
        return _load(path, root, first, set()), first


def _load(path: Path, root: Path, first: list[ctypes.CDLL], tried: set[str]) -> ctypes.CDLL:
    mode = ctypes.RTLD_GLOBAL if tried else ctypes.DEFAULT_MODE
    for _ in range(_MOST):
        try:
            return ctypes.CDLL(str(path), mode=mode)
        except OSError as fault:
            missing = _MISSING.search(str(fault))
            name = missing[missing.lastindex or 0] if missing else ""
            found = _find(Path(name).name, path.parent, root) if name else None
            if found is None:
                raise
            if found.name in tried:  # it is loaded, and the loader does not know it by this name
                if not _strike_out(path, root, name):
                    raise
                continue
            tried.add(found.name)
            first.append(_load(found, root, first, tried))
    raise OSError(f"{path.name} needs more than {_MOST} libraries")


def _find(name: str, folder: Path, root: Path) -> Path | None:
    """The file called `name`: beside the library, else anywhere in the FMU."""
    beside = folder / name
    if beside.is_file():
        return beside
    return next((p for p in sorted(root.rglob(name)) if p.is_file()), None)


@contextmanager
def _offered(path: Path, root: Path) -> Iterator[None]:
    """On Windows, the loader looks in the FMU's folders too while this is open."""
    with ExitStack() as stack:
        if sys.platform == "win32":
            for folder in (path.parent, root / "resources"):
                if folder.is_dir():
                    stack.enter_context(os.add_dll_directory(str(folder)))
        yield


def _strike_out(path: Path, root: Path, name: str) -> bool:
    """Make the loader ignore that the library at `path` (a 64-bit ELF file below `root`) needs
    `name`, whose symbols are there already; False where it does not name it."""
    if not sys.platform.startswith("linux") or not path.is_relative_to(root):
        return False
    data = bytearray(path.read_bytes())
    try:
        place = next((at for at, needed in _needed(data) if needed == name), None)
    except (struct.error, ValueError, IndexError):
        return False
    if place is None:
        return False
    struct.pack_into("<q", data, place, _IGNORED)
    path.unlink()  # another process may have it mapped
    path.write_bytes(data)
    return True


def _needed(data: bytearray) -> Iterator[tuple[int, str]]:
    """Offset and name of each DT_NEEDED entry of a 64-bit little-endian ELF file."""
    if data[:6] != b"\x7fELF\x02\x01":
        return
    table, size, count = *struct.unpack_from("<Q", data, 32), *struct.unpack_from("<HH", data, 54)
    headers = [struct.unpack_from("<IIQQQQQQ", data, table + i * size) for i in range(count)]
    loads = [(h[3], h[2], h[5]) for h in headers if h[0] == _PT_LOAD]
    for kind, _, offset, _, _, length, *_ in headers:
        if kind != _PT_DYNAMIC:
            continue
        entries = [
            (at, *struct.unpack_from("<qQ", data, at)) for at in range(offset, offset + length, 16)
        ]
        values = {tag: value for _, tag, value in entries}
        text = next(
            o + values[_DT_STRTAB] - v for v, o, n in loads if v <= values[_DT_STRTAB] < v + n
        )
        for at, tag, value in entries:
            if tag == _DT_NEEDED:
                end = data.index(0, text + value)
                yield at, data[text + value : end].decode()
