"""Arguments and options that commands share, and what their values mean."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from harness import registry
from harness.errors import UsageError

if TYPE_CHECKING:
    from harness.experiment.experiment import Experiment
    from harness.process.limits import Limits

FmuFile = Annotated[Path, typer.Argument(help="An .fmu file")]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON")]
Validate = Annotated[
    bool, typer.Option(help="Refuse an FMU whose description leaves open what it means")
]
Compile = Annotated[
    bool,
    typer.Option("--compile", help="Build a library from the FMU's sources where it lacks one"),
]
FmiLogging = Annotated[bool, typer.Option(help="Print the messages of FMUs")]
CallTimeout = Annotated[
    float | None, typer.Option(help="Seconds that one call into an FMU may take")
]
RunTimeout = Annotated[float | None, typer.Option(help="Seconds that a run may take")]
MemoryLimit = Annotated[str | None, typer.Option(help="Memory that a run may hold, as in '4 GiB'")]
Isolate = Annotated[
    bool, typer.Option(help="Let FMUs write no file but their own and open no connection")
]
ExperimentName = Annotated[
    str, typer.Argument(help="Name (see `list`), or path of a TOML, .ssp or .ssd file")
]
Jobs = Annotated[int, typer.Option(help="Processes of a study or sweep; 0: all cores")]
Changes = Annotated[
    list[str] | None, typer.Option("--set", help="Change a key of the file: key.sub=value")
]


def limits_of(call: float | None, run: float | None, memory: str | None, isolate: bool) -> Limits:
    """The limits that the flags mean; raises `UsageError`."""
    from harness.process.limits import Limits, memory_size

    given: dict[str, Any] = {} if call is None else {"call": call}
    size = None if memory is None else memory_size(memory)
    return Limits(**given, run=run, memory=size, isolate=isolate)


@contextmanager
def opened_experiment(name: str, changed: Mapping[str, Any] | None = None) -> Iterator[Experiment]:
    """The experiment of that name with settings merged into it, while its files are there."""
    from harness.experiment.experiment import Experiment
    from harness.ssp import is_package

    if is_package(name):
        from harness.ssp.to_experiment import open_experiment

        with open_experiment(name, dict(changed or {})) as experiment:
            yield experiment
    else:
        yield Experiment.load(registry.experiment(name), changed)


def for_fmus(pairs: Sequence[str] | None, validate: bool, build: bool) -> list[str]:
    """`pairs` and those that flags about all FMUs of an experiment stand for."""
    flags = ["validate_fmus=false"] * (not validate) + ["compile_fmus=true"] * build
    return [*(pairs or ()), *flags]


def settings(
    pairs: Sequence[str] | None, flags: Mapping[str, Mapping[str, Any]] | None = None
) -> dict[str, Any]:
    """The tables that `pairs` stand for, both sides as in TOML, the value else as a string:
    `seed=7`, `components.plant.step=0.005`, `connections."plant.command".delay=0.01`. Over them go
    those of `flags` that are not None. Raises `UsageError` for what is no such pair."""
    from harness.experiment.merging import merge

    found: dict[str, Any] = {}
    for pair in pairs or ():
        key, equals, text = pair.partition("=")
        if not equals or not key.strip():
            raise UsageError(f"--set {pair!r} must have the form key=value, as in --set seed=7")
        found = merge(found, _parse(pair, key, text), components=False)
    for table, values in (flags or {}).items():
        if given := {name: value for name, value in values.items() if value is not None}:
            found = merge(found, {table: given}, components=False)
    return found


def _parse(pair: str, key: str, text: str) -> dict[str, Any]:
    for value in (text, json.dumps(text)):
        try:
            return tomllib.loads(f"{key} = {value}")
        except tomllib.TOMLDecodeError:
            continue
    raise UsageError(
        f"--set {pair!r}: {key!r} is no key; join names by dots, quote those with dots"
    )
