"""Pieces of C source text, and the runtime files that all native FMUs share.

The shared half of the runtime (`c/`) is the FMI layers, the life cycle, the log, stored states;
`plant/c` and `block/c` hold the other half. In an FMU all files lie in one folder.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

MAIN_SOURCE = "all.c"
SHARED_RUNTIME = Path(__file__).parent / "c"


def runtime_files(own: Path, fmi_version: int) -> dict[str, bytes]:
    """The shared files for that FMI version and those in the folder `own`, by name."""
    other = f"fmi{5 - fmi_version}."
    paths = [path for path in SHARED_RUNTIME.iterdir() if not path.name.startswith(other)]
    paths += own.iterdir()
    return {
        path.name: path.read_bytes().replace(b"\r\n", b"\n")
        for path in sorted(paths)
        if path.suffix in (".c", ".h")
    }


def c_table(kind: str, name: str, entries: list[str]) -> str:
    """A C array; an empty one gets an entry that nobody reads, as C has no empty arrays."""
    body = "".join(f"    {entry},\n" for entry in entries or ["0"])
    return f"static const {kind} {name}[] = {{\n{body}}};\n\n"


def c_numbers(values: Iterable[float]) -> list[str]:
    """C literals."""
    special = {float("inf"): "INFINITY", float("-inf"): "-INFINITY"}
    return [special.get(value, repr(float(value))) for value in values]


def c_text(text: str) -> str:
    """A C string literal of any text, in octal escapes where it is not plain ASCII."""
    plain = [
        chr(byte) if 32 <= byte < 127 and chr(byte) not in '"\\?' else f"\\{byte:03o}"
        for byte in text.encode()
    ]
    return f'"{"".join(plain)}"'
