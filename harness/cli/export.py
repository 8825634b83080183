"""`fmu-harness export`: an experiment as a system structure package (SSP) that other tools run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from harness.cli.experiments import opened_experiment
from harness.cli.notices import notices
from harness.cli.terminal import console
from harness.cli.values import settings
from harness.errors import UsageError


def export_command(
    experiment: Annotated[
        str, typer.Argument(help="Name (see `list`), or path of a TOML, .ssp or .ssd file")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="The .ssp file to write")],
    variant: Annotated[
        list[str] | None, typer.Option(help="Export these variants only; repeatable")
    ] = None,
    fmi: Annotated[
        int | None, typer.Option(help="FMI version of our FMUs, 2 or 3; as the file says if absent")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="Change a key of the file: key.sub=value")
    ] = None,
) -> None:
    """Write an experiment as an .ssp with its FMUs; every variant is a root description of it.

    A package is written again with all that is in it, and with settings added to it by --set.
    """
    from harness.ssp.package import is_package

    if output.suffix != ".ssp":
        raise UsageError(f"--output {output} must end in .ssp")
    pairs = [*(set_ or []), *([f"fmi_version={fmi}"] if fmi is not None else [])]
    with notices():
        if is_package(experiment):
            from harness.ssp.rewrite import rewrite_package

            rewrite_package(Path(experiment), output, variant or (), settings(pairs))
        else:
            _export(experiment, output, variant, pairs)
    console().print(f"written: {output}", markup=False, soft_wrap=True)


def _export(name: str, output: Path, variant: list[str] | None, pairs: list[str]) -> None:
    from harness.export.controller import controller_fmu
    from harness.ssp.from_experiment import export_experiment

    with opened_experiment(name, settings(pairs)) as experiment:
        export_experiment(experiment, output, variant or experiment.variants, controller_fmu)
