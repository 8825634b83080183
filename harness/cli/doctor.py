"""`fmu-harness doctor`: what an FMU does, against what it says, on one page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from harness.cli.options import AsJson, Compile, FmuFile, Validate
from harness.cli.tables import show_table
from harness.cli.terminal import bar, say, say_json, table
from harness.errors import HarnessError, UsageError

if TYPE_CHECKING:
    from harness.inspection.doctor import Diagnosis

_STYLES = {"passed": "green", "failed": "bold red", "not offered": "dim"}


def doctor_command(
    fmu: FmuFile,
    as_json: AsJson = False,
    deadline: Annotated[float, typer.Option(help="Seconds that one check may take")] = 60.0,
    validate: Validate = True,
    compile_: Compile = False,
) -> None:
    """Examine the behaviour of an FMU in a disposable process; exit code 1 when a check fails."""
    from harness.fmi.sources import compiled
    from harness.inspection.doctor import examine

    fmu = compiled(fmu, validate=validate) if compile_ else fmu
    if not deadline > 0:
        raise UsageError(f"--deadline {deadline:g} must be positive")
    if as_json:
        found = examine(fmu, deadline=deadline, validate=validate)
        say_json(found.as_data())
    else:
        with bar("examination") as moved:
            found = examine(fmu, deadline=deadline, validate=validate, progress=moved)
            moved(1.0)
        _show(found)
    if not found.healthy:
        count = sum(str(f.verdict) == "failed" for f in found.findings)
        raise HarnessError(f"FMU {fmu}: {count} of {len(found.findings)} checks failed")


def _show(found: Diagnosis) -> None:
    from rich.text import Text

    head = f"{found.path.name}, FMI {found.description.fmi_version}"
    for kind in dict.fromkeys(f.interface_type for f in found.findings):
        findings = (
            (f.check, Text(str(f.verdict), style=_STYLES[str(f.verdict)]), f.detail)
            for f in found.findings
            if f.interface_type == kind
        )
        headings = ("check", "verdict", "what was seen")
        show_table(table(headings, findings, title=f"{head}, {kind}"))
    words = {True: Text("yes", style="green"), False: Text("no", style="bold red")}
    allowances = ((a.use, words[a.allowed], a.reason) for a in found.allowances)
    show_table(table(("use", "allowed", "because of"), allowances))
    for lie in found.lies:
        say(f"contradicted by its behaviour: {lie}", style="bold red")
