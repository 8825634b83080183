"""`fmu-harness validate`: the static faults of an FMU, by severity."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from harness.cli.terminal import console, say, table
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
        rows = (
            (Text(str(p.severity), style=_STYLES[str(p.severity)]), p.place, p.text, p.rule)
            for p in problems
        )
        console().print(table(("severity", "where", "what", "by"), rows))
    else:
        say(f"{fmu}: no problems found")
    errors = sum(p.severity is Severity.ERROR for p in problems)
    if errors:
        raise HarnessError(f"FMU {fmu}: {errors} error{'s' if errors > 1 else ''}")
