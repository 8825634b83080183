"""`fmu-harness verify`: the parity certificate of an FMU, replayed on this machine."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table
from rich.text import Text

from harness.cli.limits import (
    CallTimeout,
    Isolate,
    MemoryLimit,
    RunTimeout,
    interruptible,
    limits_of,
)
from harness.cli.notices import notices
from harness.cli.terminal import console
from harness.errors import HarnessError

_SHOWN = 12


def verify_command(
    fmu: Annotated[Path, typer.Argument(help="An .fmu file with a parity certificate")],
    call_timeout: CallTimeout = None,
    run_timeout: RunTimeout = None,
    memory_limit: MemoryLimit = None,
    isolate: Isolate = False,
) -> None:
    """Replay the parity certificate of an FMU; exit code 1 where it does not agree."""
    from harness.export.verify import verify

    with notices(), interruptible():
        found = verify(fmu, limits_of(call_timeout, run_timeout, memory_limit, isolate))
    out, certificate = console(), found.certificate
    out.print(
        f"{certificate.model}: {certificate.rows} steps of {certificate.step:g} s against "
        f"{certificate.reference}",
        markup=False, soft_wrap=True,
    )  # fmt: skip
    table = Table(box=None, padding=(0, 2))
    table.add_column("output")
    for title in ("difference here", "where it was made", "allowed"):
        table.add_column(title, justify="right")
    ranked = sorted(found.difference, key=lambda name: -found.difference[name])
    for name in ranked[:_SHOWN]:
        row = (found.difference[name], certificate.difference.get(name), found.allowed[name])
        table.add_row(Text(name), *("–" if value is None else f"{value:.3g}" for value in row))
    out.print(table)
    if len(ranked) > _SHOWN:
        out.print(f"and {len(ranked) - _SHOWN} more outputs, none further off")
    made = ", ".join(f"{name} {version}" for name, version in certificate.made_with.items())
    out.print(f"made with {made}", markup=False, soft_wrap=True)
    if found.off:
        raise HarnessError(
            f"FMU {fmu} does not do here what it did where it was made: "
            f"{', '.join(found.off[:3])} differ by more than is allowed"
        )
    out.print("agrees bit for bit" if found.exact else "agrees within the tolerance")
