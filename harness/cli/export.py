"""`fmu-harness export`: an experiment as a system structure package (SSP) that other tools run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from harness.cli.options import Changes, ExperimentName, opened_experiment, settings
from harness.cli.terminal import say
from harness.errors import UsageError


def export_command(
    experiment: ExperimentName,
    output: Annotated[Path, typer.Option("--output", "-o", help="The .ssp file to write")],
    variant: Annotated[
        list[str] | None, typer.Option(help="Export these variants only; repeatable")
    ] = None,
    fmi: Annotated[
        int | None, typer.Option(help="FMI version of our FMUs, 2 or 3; as the file says if absent")
    ] = None,
    set_: Changes = None,
) -> None:
    """Write an experiment as an .ssp with its FMUs; every variant is a root description of it.

    A package is written again with all that is in it, and with settings added to it by --set.
    """
    from harness.ssp import is_package

    if output.suffix != ".ssp":
        raise UsageError(f"--output {output} must end in .ssp")
    changed = settings([*(set_ or []), *([f"fmi_version={fmi}"] if fmi is not None else [])])
    if is_package(experiment):
        from harness.ssp.rewrite import rewrite_package

        rewrite_package(Path(experiment), output, variant or (), changed)
    else:
        from harness.ssp.from_experiment import export_experiment

        with opened_experiment(experiment, changed) as loaded:
            export_experiment(loaded, output, variant or loaded.variants)
    say(f"written: {output}")
