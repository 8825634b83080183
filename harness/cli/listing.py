"""`fmu-harness list`: what there is to run, build and wire."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from rich.table import Table

from harness import registry
from harness.cli.terminal import console


def list_command() -> None:
    """List plants, controllers, experiments, and the kinds of signals and imperfections."""
    from harness.instruments.imperfections import IMPERFECTIONS
    from harness.instruments.signals import SIGNALS

    out = console()
    plants = {name: registry.plant(name).description for name in registry.names(registry.PLANTS)}
    out.print(_table("plants", plants))
    controllers = {
        name: _first_line(registry.controller(name))
        for name in registry.names(registry.CONTROLLERS)
    }
    out.print(_table("controllers", controllers))
    titles = {name: _title(path) for name, path in registry.experiments().items()}
    out.print(_table("experiments", titles))
    out.print(_table("signals", {name: _first_line(kind) for name, kind in SIGNALS.items()}))
    kinds = {name: _first_line(kind) for name, kind in IMPERFECTIONS.items()}
    out.print(_table("imperfections of wires", kinds))


def _table(title: str, rows: dict[str, str]) -> Table:
    table = Table(title=title, title_justify="left", show_header=False, box=None, padding=(0, 2))
    table.add_column(style="bold", no_wrap=True)
    table.add_column()
    for name, text in rows.items():
        table.add_row(name, text)
    return table


def _first_line(thing: Any) -> str:
    return (thing.__doc__ or "").strip().split("\n\n")[0].replace("\n", " ").strip()


def _title(path: Path) -> str:
    try:
        return str(tomllib.loads(path.read_text(encoding="utf-8")).get("title", ""))
    except (OSError, ValueError) as fault:
        return f"cannot be read: {fault}"
