"""`fmu-harness list`: what there is to run, build and wire."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from harness import registry
from harness.cli.tables import show_table
from harness.cli.terminal import properties


def list_command() -> None:
    """List plants, controllers, experiments, and the kinds of signals and imperfections."""
    from harness.instruments.imperfections import IMPERFECTIONS
    from harness.instruments.signals import SIGNALS

    plants, controllers = registry.names(registry.PLANTS), registry.names(registry.CONTROLLERS)
    tables = {
        "plants": {name: registry.plant(name).description for name in plants},
        "controllers": {name: _first_line(registry.controller(name)) for name in controllers},
        "experiments": {name: _title(path) for name, path in registry.experiments().items()},
        "signals": {name: _first_line(kind) for name, kind in SIGNALS.items()},
        "imperfections of wires": {name: _first_line(k) for name, k in IMPERFECTIONS.items()},
    }
    for title, rows in tables.items():
        show_table(properties(title, rows.items()))


def _first_line(thing: Any) -> str:
    return (thing.__doc__ or "").strip().split("\n\n")[0].replace("\n", " ").strip()


def _title(path: Path) -> str:
    try:
        return str(tomllib.loads(path.read_text(encoding="utf-8")).get("title", ""))
    except (OSError, ValueError) as fault:
        return f"cannot be read: {fault}"
