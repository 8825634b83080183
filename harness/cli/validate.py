"""`fmu-harness validate`: the static faults of an FMU, by severity."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table
from rich.text import Text

from harness.cli.terminal import console
from harness.errors import HarnessError

_STYLES = {"error": "bold red", "warning": "yellow", "note": "dim"}


def validate_command(
    fmu: Annotated[Path, typer.Argument(help="An .fmu file")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON")] = False,
) -> None:
    """Check an FMU without running it; exit code 1 when it has errors."""
    from harness.inspection.problem import Severity
    from harness.inspection.static import validate

    problems = validate(fmu)
    if as_json:
        data = [problem.as_data() for problem in problems]
        typer.echo(json.dumps(data, indent=2, ensure_ascii=False))
    elif problems:
        table = Table(box=None, padding=(0, 2))
        for title in ("severity", "where", "what", "by"):
            table.add_column(title)
        for p in problems:
            severity = Text(str(p.severity), style=_STYLES[str(p.severity)])
            table.add_row(severity, Text(p.place), Text(p.text), Text(p.rule))
        console().print(table)
    else:
        console().print(f"{fmu}: no problems found", markup=False, soft_wrap=True)
    errors = sum(p.severity is Severity.ERROR for p in problems)
    if errors:
        raise HarnessError(f"FMU {fmu}: {errors} error{'s' if errors > 1 else ''}")
