"""`fmu-harness resume`: go on with a run that was interrupted, from its last checkpoint."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from harness.cli.notices import notices
from harness.cli.run import finish_run


def resume_command(
    folder: Annotated[Path, typer.Argument(help="Run folder, as `run` named it")],
    fmi_logging: Annotated[bool, typer.Option(help="Print the messages of FMUs")] = False,
) -> None:
    """Go on with an interrupted run: variants that are complete are kept, others continue from
    their last checkpoint or begin."""
    from harness.cli.run_record import opened_run

    with notices(), opened_run(folder) as record:
        finish_run(record, folder, logging=fmi_logging, resume=True)
