"""What lies in an FMU for people: a page, licences, an icon, terminals, what must be installed.

Everything is made of the same `Page` for plants and blocks, and stands where the standard of each
version expects it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from struct import pack
from xml.etree import ElementTree as ET
from zlib import compress, crc32

from fmus.packaging.model_description import xml_bytes

_LICENCE = Path(__file__).parent / "license.txt"
_SIZE = 64  # pixels of the icon, either way

Row = tuple[str, ...]


@dataclass(frozen=True)
class Page:
    """Title, paragraphs, `text` as it stands (equations), and tables: title, head, rows."""

    title: str
    paragraphs: tuple[str, ...]
    text: str
    tables: tuple[tuple[str, Row, tuple[Row, ...]], ...]

    def html(self) -> bytes:
        """A self-contained HTML page."""
        parts = (
            "<!DOCTYPE html>",
            '<html lang="en"><head><meta charset="utf-8">'
            f"<title>{escape(self.title)}</title></head>",
            f"<body><h1>{escape(self.title)}</h1>",
            *(f"<p>{escape(text)}</p>" for text in self.paragraphs),
            f"<h2>Equations</h2>\n<pre>{escape(self.text)}</pre>" if self.text else "",
            *(_table(*table) for table in self.tables if table[2]),
            "<p>Licensed under the MIT licence, see the folder licenses.</p></body></html>",
        )
        return ("\n".join(part for part in parts if part) + "\n").encode()


def documents(
    page: Page,
    fmi_version: int,
    inputs: Sequence[str],
    outputs: Sequence[str],
    *,
    needs: Iterable[str] | None = None,
) -> dict[str, bytes]:
    """The files by path in the archive; `needs` says what a portable FMU needs where it runs."""
    index = "index.html" if fmi_version == 3 else "_main.html"
    files = {
        f"documentation/{index}": page.html(),
        "documentation/licenses/license.txt": _LICENCE.read_bytes().replace(b"\r\n", b"\n"),
    }
    if needs is not None:
        files["documentation/externalDependencies.txt"] = external_dependencies(needs).encode()
    if fmi_version == 2:
        return files | {"model.png": icon()}
    return files | {
        "terminalsAndIcons/icon.png": icon(),
        "terminalsAndIcons/terminalsAndIcons.xml": _terminals(inputs, outputs),
    }


def external_dependencies(needs: Iterable[str]) -> str:
    """What a portable FMU needs on the machine that runs it."""
    listed = "".join(f"- {one}\n" for one in needs)
    return (
        "This FMU computes in Python. It needs, on the machine that runs it:\n\n"
        f"{listed}\n"
        "An importer that is itself a Python program has Python loaded already. Any other importer "
        "(a program in C, Java, ...) must be able to load Python's shared library, libpython3, or "
        "the FMU's library cannot be loaded: on Linux install it (Debian: libpython3-dev) and, "
        "where its name is not found, put it first: LD_PRELOAD=/path/to/libpython3.x.so. On "
        "Windows python3.dll must be on the PATH. PYTHONHOME tells an embedded Python where it "
        "is.\n\n"
        "The native FMU of the same model needs none of this.\n"
    )


def icon() -> bytes:
    """A PNG: a block with an arrow into it and one out of it."""
    rows = b"".join(
        b"\0" + b"".join(b"\x20" if _inked(x, y) else b"\xff" for x in range(_SIZE))
        for y in range(_SIZE)
    )
    header = pack(">IIBBBBB", _SIZE, _SIZE, 8, 0, 0, 0, 0)  # 8 bits of grey
    chunks = ((b"IHDR", header), (b"IDAT", compress(rows, 9)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        pack(">I", len(data)) + kind + data + pack(">I", crc32(kind + data))
        for kind, data in chunks
    )


def _inked(x: int, y: int) -> bool:
    inside = 18 <= x < 46 and 12 <= y < 52
    border = inside and not (20 <= x < 44 and 14 <= y < 50)
    shaft = 31 <= y < 33 and (2 <= x < 18 or 46 <= x < 62)
    head = any(tip - 6 <= x < tip and abs(y - 31.5) <= (tip - x) / 2 for tip in (18, 62))
    return border or shaft or head


def _terminals(inputs: Sequence[str], outputs: Sequence[str]) -> bytes:
    root = ET.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    graphics = ET.SubElement(root, "GraphicalRepresentation")
    box = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    ET.SubElement(graphics, "CoordinateSystem", box | {"suggestedScalingFactorTo_mm": "0.1"})
    ET.SubElement(graphics, "Icon", box)
    groups = {name: names for name, names in (("inputs", inputs), ("outputs", outputs)) if names}
    if groups:
        terminals = ET.SubElement(root, "Terminals")
        for name, names in groups.items():
            terminal = ET.SubElement(terminals, "Terminal", name=name, matchingRule="bus")
            for one in names:
                ET.SubElement(
                    terminal, "TerminalMemberVariable", variableName=one, memberName=one,
                    variableKind="signal",
                )  # fmt: skip
    return xml_bytes(root)


def _table(title: str, head: Row, rows: Iterable[Row]) -> str:
    def line(cells: Row, tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(c)}</{tag}>" for c in cells) + "</tr>"

    body = "\n".join(line(row, "td") for row in rows)
    return f"<h2>{title}</h2>\n<table>\n{line(head, 'th')}\n{body}\n</table>"
