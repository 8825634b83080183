"""Static faults of an FMU, by severity; its library is not loaded and its code not run.

    error     breaks the standard, or cannot be imported
    warning   works here and not everywhere, or costs the user something
    note      worth knowing

`doctor` is where behaviour is examined.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path

from harness.errors import FmuError
from harness.fmi.binding.interface import offered
from harness.fmi.binding.library import SUFFIXES, library_path, platform_tuple
from harness.fmi.description.document import BUILD_DESCRIPTION, parse, schema_faults
from harness.fmi.description.faults import Harm
from harness.fmi.description.model_description import (
    NUMERIC_TYPES,
    REAL_TYPES,
    ModelDescription,
    Variable,
)
from harness.fmi.fmu import Fmu
from harness.inspection.problem import PLACE, Problem, Severity, error, listed, note, warning
from harness.inspection.structure import structure_problems
from harness.system.units import Unit

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
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
            yield from _archive(fmu)
            yield from _claims(fmu.description)
            yield from _variables(fmu.description)
            yield from _structure(fmu.description)
            yield from structure_problems(fmu.description)
    except FmuError as fault:
        yield error("archive", str(fault))


def _document(fmu: Fmu) -> Iterator[Problem]:
    """What was let pass when the description was read, and what `sources` breaks."""
    for fault in fmu.faults:
        graded = warning if fault.harm is Harm.NONE else error
        yield graded(PLACE, str(fault), fault.rule)
    build = fmu.folder / BUILD_DESCRIPTION
    if build.is_file():
        for fault in schema_faults(parse(build, BUILD_DESCRIPTION), _BUILD_SCHEMA):
            yield warning(BUILD_DESCRIPTION, str(fault), fault.rule)


def _archive(fmu: Fmu) -> Iterator[Problem]:
    d, folder = fmu.description, fmu.folder
    there = sorted(p.name for p in (folder / "binaries").glob("*") if p.is_dir())
    sources = (folder / "sources").is_dir()
    for kind, capabilities in offered(d).items():
        identifier = capabilities.model_identifier
        if not _IDENTIFIER.fullmatch(identifier):
            yield error(PLACE, f"model identifier {identifier!r} of {kind} is no C identifier")
        if not there:
            word = "it has sources only" if sources else "it has neither binaries nor sources"
            graded = warning if sources else error
            yield graded("binaries", f"{kind} runs nowhere: {word}")
            continue
        try:
            library_path(folder, identifier, d.fmi_major)
        except FmuError as fault:
            yield warning("binaries", f"not for {platform_tuple()}: {fault}")
    for name in there:
        if not any(p.suffix in SUFFIXES for p in (folder / "binaries" / name).iterdir()):
            yield warning(f"binaries/{name}", "holds no library")
    if not (folder / "documentation").is_dir():
        yield note("archive", "has no documentation")


def _claims(d: ModelDescription) -> Iterator[Problem]:
    for kind, c in offered(d).items():
        if c.can_serialize_fmu_state and not c.can_get_and_set_fmu_state:
            text = f"{kind} claims to serialise a state that it can neither get nor set"
            yield error(PLACE, text)
    if not offered(d):
        yield error(PLACE, "offers no kind of interface")
    if d.step_size is None and not (d.co_simulation and d.co_simulation.fixed_internal_step_size):
        yield note(PLACE, "suggests no step size; importers will choose one")
    if d.stop_time is None:
        yield note(PLACE, "suggests no stop time")
    if not d.description:
        yield note(PLACE, "has no description")


def _variables(d: ModelDescription) -> Iterator[Problem]:
    variables = d.variables.values()
    for v in variables:
        if v.start is not None and v.type in NUMERIC_TYPES:
            yield from _start(v)
    ports = [v for v in variables if v.causality in ("input", "output", "parameter")]
    unitless = [v.name for v in ports if v.type in REAL_TYPES and v.unit is None]
    if unitless:
        text = "no unit, so connections to it are not checked"
        yield note(f"variables {listed(unitless)}", text)
    undescribed = [v.name for v in ports if not v.description]
    if undescribed:
        yield note(f"variables {listed(undescribed)}", "no description")
    units = {v.unit for v in variables if v.unit is not None}
    baseless = sorted(unit for unit in units if d.units.get(unit, _NO_UNIT).exponents is None)
    if baseless:
        text = "not expressed in base units, so they cannot be converted"
        yield warning(f"units {listed(baseless)}", text)


_NO_UNIT = Unit("")


def _start(v: Variable) -> Iterator[Problem]:
    low = -math.inf if v.minimum is None else v.minimum
    high = math.inf if v.maximum is None else v.maximum
    values = (float(_TRUTH.get(item, item)) for item in str(v.start).split())
    value = next((value for value in values if value < low or value > high), None)
    if value is not None:
        text = f"its start value {value:g} lies outside its range {low:g} to {high:g}"
        yield error(f"variable {v.name}", text)


def _structure(d: ModelDescription) -> Iterator[Problem]:
    silent = [name for name, inputs in d.feedthrough.items() if inputs is None]
    if silent and d.inputs:
        text = "no statement on which inputs they depend, so importers must assume all of them"
        yield warning(f"outputs {listed(silent)}", text)
    for kind, c in offered(d).items():
        if not c.can_get_and_set_fmu_state:
            text = f"no snapshots in {kind}: no rollback, no iterative coupling, no resume"
            yield note(PLACE, text)
        if c.can_be_instantiated_only_once:
            yield warning(PLACE, f"{kind}: one instance a process")
