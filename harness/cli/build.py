"""`fmu-harness build`: write the FMUs of plants as files."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Annotated

import typer

from harness import registry
from harness.cli.notices import notices
from harness.cli.terminal import console
from harness.errors import HarnessError, UsageError


def build_command(
    plants: Annotated[
        list[str] | None, typer.Argument(help="Plants; all when none is named")
    ] = None,
    fmi: Annotated[
        list[int] | None, typer.Option(help="FMI version, 2 or 3; both when absent")
    ] = None,
    output: Annotated[Path, typer.Option(help="Folder for the .fmu files")] = Path("fmu"),
    portable: Annotated[bool, typer.Option(help="Python packaging, no compiler needed")] = False,
) -> None:
    """Write plants as FMUs: OUTPUT/fmi2/NAME.fmu, OUTPUT/fmi3/NAME.fmu."""
    out = console()
    versions = [2] if portable else (fmi or [2, 3])
    for version in versions:
        if version not in (2, 3):
            raise UsageError(f"FMI version {version} cannot be built; choose 2 or 3")
    with notices():
        for name in plants or registry.names(registry.PLANTS):
            plant = registry.plant(name)
            for version in versions:
                folder = output / ("portable" if portable else f"fmi{version}")
                target = folder / f"{plant.name}.fmu"
                try:
                    built = registry.plant_fmu(name, version, portable=portable)
                    folder.mkdir(parents=True, exist_ok=True)
                    shutil.copyfile(built, target)
                except OSError as fault:
                    raise HarnessError(f"{target} cannot be written: {fault}") from fault
                out.print(
                    f"{target}  {target.stat().st_size / 1024:.0f} KiB",
                    markup=False,
                    soft_wrap=True,
                )
