"""`fmu-harness validate`: the static faults of an FMU, by severity."""

from __future__ import annotations

from dataclasses import asdict

from harness.cli.options import AsJson, FmuFile
from harness.cli.tables import show_table
from harness.cli.terminal import say, say_json, table
from harness.errors import HarnessError

_STYLES = {"error": "bold red", "warning": "yellow", "note": "dim"}


def validate_command(fmu: FmuFile, as_json: AsJson = False) -> None:
    """Check an FMU without running it; exit code 1 when it has errors."""
    from rich.text import Text

    from harness.inspection.problem import Severity
    from harness.inspection.static import validate

    problems = validate(fmu)
    if as_json:
        say_json([asdict(problem) for problem in problems])
    elif problems:
        rows = (
            (Text(str(p.severity), style=_STYLES[str(p.severity)]), p.place, p.text, p.rule)
            for p in problems
        )
        show_table(table(("severity", "where", "what", "by"), rows))
    else:
        say(f"{fmu}: no problems found")
    errors = sum(p.severity is Severity.ERROR for p in problems)
    if errors:
        raise HarnessError(f"FMU {fmu}: {errors} error{'s' if errors > 1 else ''}")
