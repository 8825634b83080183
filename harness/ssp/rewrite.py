"""A package written again: its descriptions as they were read, its other files byte for byte.

Settings can be added, which go to our own annotations; start and stop time have their place in
SSP. Refused are settings of components and connections, which are the package's own matter.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from harness.errors import ExperimentError, UsageError, nearest
from harness.experiment.merging import merge
from harness.ssp import DEFAULT
from harness.ssp.document import DefaultExperiment, SystemStructure
from harness.ssp.package import Package, files_of, open_package, save_package
from harness.ssp.settings import TYPE, annotation, settings_of
from harness.ssp.to_experiment import TOP_SETTINGS, variant_names

_TIMES = {"start_time", "stop_time"}


def rewrite_package(
    source: Path, target: Path, variants: Sequence[str], settings: Mapping[str, Any]
) -> None:
    """Write the package at `source` to `target`, with all or some of its variants (the first is
    the default then) and with `settings` added to each. Raises `ExperimentError`, `UsageError`."""
    for key in settings:
        legal = (*TOP_SETTINGS, *sorted(_TIMES))
        if key not in legal:
            raise UsageError(
                f"--set {key}: a package takes settings of its run; {nearest(key, legal)}"
            )
    with open_package(source) as package:
        chosen = _chosen(package, variants)
        structures = {
            (DEFAULT if i == 0 else file): with_settings(
                package.structures[file], settings, package.where(file)
            )
            for i, file in enumerate(chosen)
        }
        save_package(target, structures, files_of(package))


def with_settings(
    structure: SystemStructure, settings: Mapping[str, Any], where: str
) -> SystemStructure:
    """A description with settings of ours added."""
    if not settings:
        return structure
    own = settings_of(structure.annotations, TOP_SETTINGS, where)
    own = merge(own, {k: v for k, v in settings.items() if k not in _TIMES})
    others = tuple(one for one in structure.annotations if one.type != TYPE)
    times = {key: float(value) for key, value in settings.items() if key in _TIMES}
    experiment = structure.experiment
    if times:
        experiment = replace(experiment or DefaultExperiment(), **times)  # type: ignore[arg-type]
    return replace(structure, experiment=experiment, annotations=(*others, *annotation(own)))


def _chosen(package: Package, variants: Sequence[str]) -> list[str]:
    files = {name: file for file, name in variant_names(package).items()}
    for name in variants:
        if name not in files:
            raise ExperimentError(f"{package.path}: no variant {name!r}; {nearest(name, files)}")
    return [files[name] for name in variants] or list(files.values())
