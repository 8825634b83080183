"""Whether a printf format of an FMU can be expanded with the arguments that came with it.

An FMU that logs "%s" without an argument makes the C library read a pointer that nobody passed,
and "%n" makes it write through one. The arguments of a variadic call can be looked at on x86-64
with the System V convention; there every pointer for "%s" is tried before it is used. Elsewhere
only "%n" is refused. A format that cannot be expanded is shown as it is.
"""

from __future__ import annotations

import ctypes
import os
import platform
import re
import sys
from functools import cache, lru_cache

_DIRECTIVE = re.compile(
    rb"%(?P<flags>[-+ #0'I]*)(?P<width>\*|\d+)?(?:\.(?P<precision>\*|\d*))?"
    rb"(?P<length>hh|h|ll|l|q|L|j|z|Z|t)?(?P<kind>[a-zA-Z%])?"
)
_WIDEST = 10_000
_PAGE = 4096
_GENERAL_AREA, _AREA = 48, 176  # bytes of the register save area: general, with vector registers


class _VaList(ctypes.Structure):
    """va_list of the System V convention for x86-64."""

    _fields_ = (
        ("general", ctypes.c_uint32),
        ("vector", ctypes.c_uint32),
        ("overflow", ctypes.c_uint64),
        ("registers", ctypes.c_uint64),
    )


def expandable(form: bytes, arguments: int) -> bool:
    """Whether vsnprintf may be given `form` and the va_list at address `arguments`."""
    parsed = _directives(form)
    if parsed is None:
        return False
    return b"s" not in parsed or not _inspectable() or _strings_readable(parsed, arguments)


@lru_cache(maxsize=1024)
def _directives(form: bytes) -> tuple[bytes, ...] | None:
    """One letter for each argument: "s" a string, "f" a vector register, "L" a long double, "i"
    anything else; None where the format must not be expanded."""
    found: list[bytes] = []
    for match in _DIRECTIVE.finditer(form):
        kind, length = match["kind"], match["length"]
        sizes = [match["width"] or b"", match["precision"] or b""]
        if kind in (None, b"n") or any(s.isdigit() and int(s) > _WIDEST for s in sizes):
            return None
        if kind == b"%":
            continue
        found += [b"i"] * sizes.count(b"*")
        if kind in b"aAeEfFgG":
            found.append(b"L" if length == b"L" else b"f")
        elif kind in b"diouxXcCp":
            found.append(b"i")
        elif kind == b"s" and length is None:
            found.append(b"s")
        elif kind != b"m":
            return None
    return tuple(found)


def _strings_readable(kinds: tuple[bytes, ...], arguments: int) -> bool:
    given = _VaList.from_address(arguments)
    general, vector, overflow = given.general, given.vector, given.overflow
    for kind in kinds:
        if kind == b"L":
            overflow = (overflow + 15) // 16 * 16 + 16
            continue
        if kind == b"f" and vector < _AREA:
            vector += 16
            continue
        if kind != b"f" and general < _GENERAL_AREA:
            place = given.registers + general
            general += 8
        else:
            place = overflow
            overflow += 8
        if kind == b"s" and not _text_at(ctypes.c_uint64.from_address(place).value):
            return False
    return True


def _text_at(address: int) -> bool:
    """Whether a string that ends can be read at `address`; NULL is printed by the C library."""
    if address == 0:
        return True
    while readable(address):
        rest = _PAGE - address % _PAGE
        if b"\0" in ctypes.string_at(address, rest):
            return True
        address += rest
    return False


def readable(address: int) -> bool:
    """Whether a byte can be read at `address`: the kernel is asked, which does not crash."""
    write, probe, away = _probe()
    if address < _PAGE or write(probe, ctypes.c_void_p(address), 1) != 1:
        return False
    os.read(away, 1)
    return True


@cache
def _probe() -> tuple[ctypes._NamedFuncPointer, int, int]:
    away, probe = os.pipe()
    write = ctypes.CDLL(None).write
    write.argtypes = (ctypes.c_int, ctypes.c_void_p, ctypes.c_size_t)
    write.restype = ctypes.c_ssize_t
    return write, probe, away


@cache
def _inspectable() -> bool:
    return sys.platform in ("linux", "darwin") and platform.machine() in ("x86_64", "AMD64")
