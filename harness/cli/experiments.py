"""Experiments as commands name them: a registered name, a TOML file, or a package (SSP)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Any

import typer

from harness import registry

if TYPE_CHECKING:
    from harness.experiment.experiment import Experiment

ExperimentName = Annotated[
    str, typer.Argument(help="Name (see `list`), or path of a TOML, .ssp or .ssd file")
]
Changes = Annotated[
    list[str] | None, typer.Option("--set", help="Change a key of the file: key.sub=value")
]


@contextmanager
def opened_experiment(name: str, changed: Mapping[str, Any] | None = None) -> Iterator[Experiment]:
    """The experiment of that name with settings merged into it, while its files are there."""
    from harness.experiment.experiment import Experiment
    from harness.ssp.package import is_package
    from harness.ssp.to_experiment import open_experiment

    if is_package(name):
        with open_experiment(name, dict(changed or {})) as experiment:
            yield experiment
    else:
        yield Experiment.load(registry.experiment(name), changed)
