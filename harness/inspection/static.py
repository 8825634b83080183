"""Static faults of an FMU, by severity; its library is not loaded and its code not run.

    error     breaks the standard, or cannot be imported
    warning   works here and not everywhere, or costs the user something
    note      worth knowing

`doctor` is where behaviour is examined.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from harness.errors import FmuError
from harness.fmi.binding.library import library_path, platform_tuple
from harness.fmi.description.document import BUILD_DESCRIPTION, parse, schema_faults
from harness.fmi.description.faults import Harm
from harness.fmi.description.model_description import (
    NUMERIC_TYPES,
    REAL_TYPES,
    Capabilities,
    ModelDescription,
)
from harness.fmi.fmu import Fmu
from harness.inspection.problem import PLACE, Problem, Severity, listed
from harness.inspection.structure import structure_problems
from harness.system.units import Unit

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_LIBRARIES = {".so", ".dll", ".dylib"}
_BUILD_SCHEMA = "fmi3/fmi3BuildDescription.xsd"
_TRUTH = {"true": "1", "false": "0"}


def validate(path: str | Path) -> tuple[Problem, ...]:
    """All static problems of the FMU at `path`, the gravest first; empty when there is none.

    What keeps it from being read is a problem, too, so nothing is raised.
    """
    found = list(dict.fromkeys(_problems(Path(path))))
    order = list(Severity)
    return tuple(sorted(found, key=lambda problem: order.index(problem.severity)))


def _problems(path: Path) -> Iterator[Problem]:
    try:
        with Fmu(path, validate=False) as fmu:
            yield from _document(fmu)
            yield from _platforms(fmu)
            yield from _claims(fmu.description)
            yield from _variables(fmu.description)
            yield from _structure(fmu.description)
            yield from structure_problems(fmu.description)
            yield from _files(fmu)
    except FmuError as fault:
        yield Problem(Severity.ERROR, "archive", str(fault))


def _document(fmu: Fmu) -> Iterator[Problem]:
    """What was let pass when the description was read, and what `sources` breaks."""
    for fault in fmu.faults:
        severity = Severity.WARNING if fault.harm is Harm.NONE else Severity.ERROR
        yield Problem(severity, PLACE, str(fault), fault.rule)
    build = fmu.folder / BUILD_DESCRIPTION
    if build.is_file():
        for fault in schema_faults(parse(build, BUILD_DESCRIPTION), _BUILD_SCHEMA):
            yield Problem(Severity.WARNING, BUILD_DESCRIPTION, str(fault), fault.rule)


def _kinds(d: ModelDescription) -> dict[str, Capabilities]:
    kinds = {
        "co-simulation": d.co_simulation, "model exchange": d.model_exchange,
        "scheduled execution": d.scheduled_execution,
    }  # fmt: skip
    return {name: kind for name, kind in kinds.items() if kind is not None}


def _platforms(fmu: Fmu) -> Iterator[Problem]:
    d, folder = fmu.description, fmu.folder
    there = sorted(p.name for p in (folder / "binaries").glob("*") if p.is_dir())
    sources = (folder / "sources").is_dir()
    for kind, capabilities in _kinds(d).items():
        identifier = capabilities.model_identifier
        if not _IDENTIFIER.fullmatch(identifier):
            text = f"model identifier {identifier!r} of {kind} is no C identifier"
            yield Problem(Severity.ERROR, PLACE, text)
        if not there:
            word = "it has sources only" if sources else "it has neither binaries nor sources"
            severity = Severity.WARNING if sources else Severity.ERROR
            yield Problem(severity, "binaries", f"{kind} runs nowhere: {word}")
            continue
        try:
            library_path(folder, identifier, d.fmi_major)
        except FmuError as fault:
            yield Problem(Severity.WARNING, "binaries", f"not for {platform_tuple()}: {fault}")
    for name in there:
        if not any(p.suffix in _LIBRARIES for p in (folder / "binaries" / name).iterdir()):
            yield Problem(Severity.WARNING, f"binaries/{name}", "holds no library")


def _claims(d: ModelDescription) -> Iterator[Problem]:
    place = PLACE
    for kind, c in _kinds(d).items():
        if c.can_serialize_fmu_state and not c.can_get_and_set_fmu_state:
            text = f"{kind} claims to serialise a state that it can neither get nor set"
            yield Problem(Severity.ERROR, place, text)
    if not _kinds(d):
        yield Problem(Severity.ERROR, place, "offers no kind of interface")
    if d.step_size is None and not (d.co_simulation and d.co_simulation.fixed_internal_step_size):
        text = "suggests no step size; importers will choose one"
        yield Problem(Severity.NOTE, place, text)
    if d.stop_time is None:
        yield Problem(Severity.NOTE, place, "suggests no stop time")
    if not d.description:
        yield Problem(Severity.NOTE, place, "has no description")


def _variables(d: ModelDescription) -> Iterator[Problem]:
    unitless, undescribed, baseless = [], [], set()
    for v in d.variables.values():
        place = f"variable {v.name}"
        if v.start is not None and v.type in NUMERIC_TYPES:
            yield from _start(place, v.start, v.minimum, v.maximum)
        if v.causality in ("input", "output", "parameter"):
            if v.type in REAL_TYPES and v.unit is None:
                unitless.append(v.name)
            if not v.description:
                undescribed.append(v.name)
        if v.unit is not None and d.units.get(v.unit, _NO_UNIT).exponents is None:
            baseless.add(v.unit)
    for names, severity, text in (
        (unitless, Severity.NOTE, "no unit, so connections to it are not checked"),
        (undescribed, Severity.NOTE, "no description"),
    ):
        if names:
            yield Problem(severity, f"variables {listed(names)}", text)
    if baseless:
        text = "not expressed in base units, so they cannot be converted"
        yield Problem(Severity.WARNING, f"units {listed(sorted(baseless))}", text)


_NO_UNIT = Unit("")


def _start(place: str, start: str, low: float | None, high: float | None) -> Iterator[Problem]:
    for item in start.split():
        value = float(_TRUTH.get(item, item))
        outside = (low is not None and value < low) or (high is not None and value > high)
        if outside:
            bounds = (float("-inf") if low is None else low, float("inf") if high is None else high)
            text = (
                f"its start value {value:g} lies outside its range {bounds[0]:g} to {bounds[1]:g}"
            )
            yield Problem(Severity.ERROR, place, text)
            return


def _structure(d: ModelDescription) -> Iterator[Problem]:
    silent = [name for name, inputs in d.feedthrough.items() if inputs is None]
    if silent and d.inputs:
        text = "no statement on which inputs they depend, so importers must assume all of them"
        yield Problem(Severity.WARNING, f"outputs {listed(silent)}", text)
    for kind, c in _kinds(d).items():
        if not c.can_get_and_set_fmu_state:
            text = f"no snapshots in {kind}: no rollback, no iterative coupling, no resume"
            yield Problem(Severity.NOTE, PLACE, text)
        if c.can_be_instantiated_only_once:
            text = f"{kind}: one instance a process"
            yield Problem(Severity.WARNING, PLACE, text)


def _files(fmu: Fmu) -> Iterator[Problem]:
    if not (fmu.folder / "documentation").is_dir():
        yield Problem(Severity.NOTE, "archive", "has no documentation")
