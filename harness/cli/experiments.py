"""Experiments as commands name them: a registered name, a TOML file, or a package (SSP)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from harness import registry
from harness.cli.values import settings

if TYPE_CHECKING:
    from harness.experiment.experiment import Experiment


@contextmanager
def opened_experiment(name: str, pairs: Sequence[str] = ()) -> Iterator[Experiment]:
    """The experiment of that name with settings (`key=value`), while its files are there."""
    from harness.experiment.experiment import Experiment
    from harness.ssp.package import is_package
    from harness.ssp.to_experiment import open_experiment

    if is_package(name):
        with open_experiment(name, settings(pairs)) as experiment:
            yield experiment
    else:
        yield Experiment.load(registry.experiment(name), settings(pairs))
