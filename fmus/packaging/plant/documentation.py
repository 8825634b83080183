"""The page of documentation inside an FMU: what the plant is and a table of its variables."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from fmus.declaration import PlantModel

_LICENCE = (
    "Licensed under the MIT licence: free to use, copy, change and pass on, without warranty."
)


def documentation_page(plant: PlantModel) -> bytes:
    """A self-contained HTML page."""
    states = ((s.name, s.unit, f"{s.start:g}", s.description) for s in plant.states)
    inputs = ((v.name, v.unit, f"{v.start:g}", v.description) for v in plant.inputs)
    outputs = ((v.name, v.unit, v.description) for v in plant.outputs)
    parameters = (
        (p.name, p.unit, f"{p.value:g}", p.description, p.source) for p in plant.parameters
    )
    parts = (
        "<!DOCTYPE html>",
        f'<html lang="en"><head><meta charset="utf-8"><title>{escape(plant.name)}</title></head>',
        f"<body><h1>{escape(plant.name)} {escape(plant.version)}</h1>",
        f"<p>{escape(plant.description)}</p>",
        _table("Inputs", ("name", "unit", "start", "description"), inputs),
        _table("Outputs", ("name", "unit", "description"), outputs),
        _table("States", ("name", "unit", "start", "description"), states),
        _table("Parameters", ("name", "unit", "value", "description", "source"), parameters),
        f"<p>{_LICENCE}</p></body></html>",
    )
    return ("\n".join(parts) + "\n").encode()


def _table(title: str, head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    def line(cells: tuple[str, ...], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(c)}</{tag}>" for c in cells) + "</tr>"

    body = "\n".join(line(row, "td") for row in rows)
    return f"<h2>{title}</h2>\n<table>\n{line(head, 'th')}\n{body}\n</table>"
