"""`fmu-harness doctor`: what an FMU does, against what it says, on one page."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table
from rich.text import Text

from harness.cli.limits import Validate, interruptible
from harness.cli.progress import bar
from harness.cli.terminal import console
from harness.errors import HarnessError, UsageError

if TYPE_CHECKING:
    from harness.inspection.doctor import Diagnosis

_STYLES = {"passed": "green", "failed": "bold red", "not offered": "dim"}


def doctor_command(
    fmu: Annotated[Path, typer.Argument(help="An .fmu file")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON")] = False,
    deadline: Annotated[float, typer.Option(help="Seconds that one check may take")] = 60.0,
    validate: Validate = True,
) -> None:
    """Examine the behaviour of an FMU in a disposable process; exit code 1 when a check fails."""
    from harness.inspection.doctor import examine

    if not deadline > 0:
        raise UsageError(f"--deadline {deadline:g} must be positive")
    if as_json:
        found = examine(fmu, deadline=deadline, validate=validate)
        typer.echo(json.dumps(found.as_data(), indent=2, ensure_ascii=False))
    else:
        with interruptible(), bar() as shown:
            task = shown.add_task("examination", total=None)
            found = examine(
                fmu,
                deadline=deadline,
                validate=validate,
                progress=lambda name, k, n: shown.update(
                    task, description=name, completed=k, total=n
                ),
            )
            shown.update(task, description="examination", completed=1, total=1)
        _show(found)
    if not found.healthy:
        count = sum(str(f.verdict) == "failed" for f in found.findings)
        raise HarnessError(f"FMU {fmu}: {count} of {len(found.findings)} checks failed")


def _show(found: Diagnosis) -> None:
    out = console()
    for kind in dict.fromkeys(f.interface_type for f in found.findings):
        out.print(_findings(found, kind))
    out.print(_allowances(found))
    for lie in found.lies:
        out.print(Text(f"contradicted by its behaviour: {lie}", style="bold red"), soft_wrap=True)


def _findings(found: Diagnosis, kind: str) -> Table:
    head = Text(f"{found.path.name}, FMI {found.description.fmi_version}, {kind}")
    table = Table(title=head, title_justify="left", box=None, padding=(0, 2))
    for title in ("check", "verdict", "what was seen"):
        table.add_column(title)
    for f in (f for f in found.findings if f.interface_type == kind):
        verdict = Text(str(f.verdict), style=_STYLES[str(f.verdict)])
        table.add_row(Text(f.check), verdict, Text(f.detail))
    return table


def _allowances(found: Diagnosis) -> Table:
    table = Table(box=None, padding=(0, 2))
    for title in ("use", "allowed", "because of"):
        table.add_column(title)
    for a in found.allowances:
        word = Text("yes", style="green") if a.allowed else Text("no", style="bold red")
        table.add_row(a.use, word, Text(a.reason))
    return table
