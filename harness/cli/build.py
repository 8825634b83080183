"""`fmu-harness build`: write the FMUs of plants and controllers as files."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from harness import registry
from harness.cli.options import settings
from harness.cli.terminal import bar, say
from harness.errors import UsageError, nearest
from harness.results.atomic import atomic_write, writing

if TYPE_CHECKING:
    from harness.export.find import FoundBlock


def build_command(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            help="Plants, controllers, or package.module:Class; all plants when none is named"
        ),
    ] = None,
    fmi: Annotated[
        list[int] | None,
        typer.Option(help="FMI version, 2 or 3; both when absent, 2 where portable"),
    ] = None,
    output: Annotated[Path, typer.Option(help="Folder for the .fmu files")] = Path("fmu"),
    portable: Annotated[bool, typer.Option(help="Python packaging, no compiler needed")] = False,
    targets: Annotated[
        list[str] | None,
        typer.Option(help="Platforms such as win64 or aarch64-linux, or 'all'; repeatable"),
    ] = None,
    sample_time: Annotated[
        float | None, typer.Option(help="Sample time of controllers in seconds")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", help="Parameter of the controller, or key of the experiment"),
    ] = None,
    experiment: Annotated[
        str | None, typer.Option(help="Build the controllers of this experiment")
    ] = None,
    variant: Annotated[str | None, typer.Option(help="Its variant; the first when absent")] = None,
    component: Annotated[
        list[str] | None, typer.Option(help="Its controllers; all when absent; repeatable")
    ] = None,
    name: Annotated[
        str | None, typer.Option(help="Name of the FMU, where there is one plant or controller")
    ] = None,
) -> None:
    """Write plants and controllers as FMUs: OUTPUT/fmi2/NAME.fmu, OUTPUT/fmi3/NAME.fmu, with
    --portable OUTPUT/portable/NAME.fmu and, with --fmi 3, OUTPUT/portable-fmi3/NAME.fmu."""
    versions = fmi or ([2] if portable else [2, 3])
    for version in versions:
        if version not in (2, 3):
            raise UsageError(f"FMI version {version} cannot be built; choose 2 or 3")
    platforms = tuple(one for given in targets or () for one in given.split(",") if one)
    if portable and platforms:
        raise UsageError(
            "--targets are for native FMUs; leave it out, --portable runs where Python does"
        )
    if experiment is not None and names:
        raise UsageError("name controllers, or an experiment with --component, not both")
    if experiment is None and (variant is not None or component):
        raise UsageError("--variant and --component belong to --experiment NAME")
    asked: Sequence[str | FoundBlock]
    if experiment is not None:
        asked = _of_experiment(experiment, variant, component or [], settings(set_), name)
    else:
        asked = _named(names or registry.names(registry.PLANTS), sample_time, set_, name)
    kind = "portable-" if portable else ""
    every = [(one, version) for one in asked for version in versions]
    with bar("build") as moved:  # the first FMU for another platform takes minutes
        for place, (one, version) in enumerate(every):
            told = one.partition(":")[2] or one if isinstance(one, str) else one.name
            moved(place / len(every), f"{told}, FMI {version}")
            folder = "portable" if portable and version == 2 else f"{kind}fmi{version}"
            made, built = _built(one, name, version, portable=portable, targets=platforms)
            _copy(built, output / folder / f"{made}.fmu")
        moved(1.0)


def _of_experiment(
    experiment: str,
    variant: str | None,
    components: list[str],
    changed: dict[str, Any],
    name: str | None,
) -> list[FoundBlock]:
    from harness.export.find import controllers_of

    found = controllers_of(experiment, variant, components, changed)
    if name is not None and len(found) > 1:
        known = ", ".join(one.name for one in found)
        raise UsageError(f"--name is for one controller; choose a --component of {known}")
    return found


def _built(
    asked: str | FoundBlock, name: str | None, version: int, **packaging: Any
) -> tuple[str, Path]:
    """The name of the FMU of a plant or controller, which is `name` if given, and its file."""
    from harness.export.controller import identifier

    if isinstance(asked, str):
        from harness.export.plant import certified_plant_fmu

        made = identifier(name) if name else registry.plant(asked).name
        return made, certified_plant_fmu(asked, version, rename=name, **packaging)
    from harness.export.controller import controller_fmu

    chosen = identifier(name or asked.name)
    return chosen, controller_fmu(
        asked.block, chosen, asked.sample_time, version, phase=asked.phase,
        description=asked.description, **packaging,
    )  # fmt: skip


def _copy(built: Path, target: Path) -> None:
    with writing(f"{target} cannot be written", target.parent), atomic_write(target) as partial:
        shutil.copyfile(built, partial)
    size = target.stat().st_size / 1024
    say(f"{target}  {size:.0f} KiB")


def _is_plant(name: str) -> bool:
    """Whether `name` is a plant; raises `UsageError` for a name that is nothing."""
    plants, controllers = registry.names(registry.PLANTS), registry.names(registry.CONTROLLERS)
    if name in plants or name in controllers:
        return name in plants
    if ":" not in name:
        raise UsageError(
            f"no plant or controller {name!r}; {nearest(name, [*plants, *controllers])} (or "
            "'package.module:Class' for your own)"
        )
    return hasattr(registry.plant(name), "fmu")


def _named(
    names: list[str], sample_time: float | None, set_: list[str] | None, name: str | None
) -> Sequence[str | FoundBlock]:
    """The plants and controllers that are registered as `names`, or "package.module:Class"."""
    if name is not None and len(names) > 1:
        raise UsageError(f"--name is for one plant or controller, here are {len(names)}; give one")
    plants = list(filter(_is_plant, names))
    if len(plants) == len(names):
        if sample_time is not None or set_:
            raise UsageError(
                "--sample-time and --set are for controllers, not for plants; leave them out"
            )
        return plants
    from harness.export.find import named_controller

    return [
        one if one in plants else named_controller(one, sample_time, settings(set_), name)
        for one in names
    ]
