"""`fmu-harness verify`: the parity certificate of an FMU, replayed on this machine."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from harness.cli import options
from harness.cli.tables import show_table
from harness.cli.terminal import say, table
from harness.errors import HarnessError

_SHOWN = 12


def verify_command(
    fmu: Annotated[Path, typer.Argument(help="An .fmu file with a parity certificate")],
    call_timeout: options.CallTimeout = None,
    run_timeout: options.RunTimeout = None,
    memory_limit: options.MemoryLimit = None,
    isolate: options.Isolate = False,
) -> None:
    """Replay the parity certificate of an FMU; exit code 1 where it does not agree."""
    from harness.export.verify import verify

    found = verify(fmu, options.limits_of(call_timeout, run_timeout, memory_limit, isolate))
    certificate = found.certificate
    say(
        f"{certificate.model}: {certificate.rows} steps of {certificate.step:g} s against "
        f"{certificate.reference}"
    )
    ranked = sorted(found.difference, key=lambda name: -found.difference[name])
    rows = []
    for name in ranked[:_SHOWN]:
        row = (found.difference[name], certificate.difference.get(name), found.allowed[name])
        rows.append((name, *("–" if value is None else f"{value:.3g}" for value in row)))
    headings = ("output", "difference here", "where it was made", "allowed")
    show_table(table(headings, rows, right=headings[1:]))
    if len(ranked) > _SHOWN:
        say(f"and {len(ranked) - _SHOWN} more outputs, none further off")
    made = ", ".join(f"{name} {version}" for name, version in certificate.made_with.items())
    say(f"made with {made}")
    if found.off:
        raise HarnessError(
            f"FMU {fmu} does not do here what it did where it was made: "
            f"{', '.join(found.off[:3])} differ by more than is allowed"
        )
    say("agrees bit for bit" if found.exact else "agrees within the tolerance")
