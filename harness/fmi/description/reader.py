"""Reads an unpacked FMU's documents into a `ModelDescription`, with what is wrong with them.

The document is parsed once, held against the schema of the standard, and read; whatever the
numbers in it claim, nothing of their size is allocated, and those that cannot be meant (a step
size below 0, say) are left out and told.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from harness.fmi.description.additions import read_layered_standards, read_terminals
from harness.fmi.description.capabilities import capabilities, experiment, judge_name
from harness.fmi.description.definitions import read_types, read_units
from harness.fmi.description.document import model_description_root, schema_faults
from harness.fmi.description.faults import Fault, Harm, notes
from harness.fmi.description.model_description import MAX_ELEMENTS, ModelDescription, Variable
from harness.fmi.description.numbers import integer
from harness.fmi.description.structure import (
    circle_faults,
    direct_dependencies,
    feedthrough,
    read_unknowns,
)
from harness.fmi.description.variables import VariableReader


def read_model_description(
    folder: Path, source: Path, *, validate: bool = True
) -> tuple[ModelDescription, tuple[Fault, ...]]:
    """Read the unpacked FMU in `folder`; `source` is the archive, for messages.

    Returns what it says and the faults that were let pass. Raises `FmuError` when the document is
    missing, malformed, of an unknown version, could do harm, or, where `validate`, leaves open
    what it means.
    """
    root = model_description_root(folder, source)
    faults = list(schema_faults(root))
    described = _described(root, folder, faults)
    faults += circle_faults(described.variables)
    notes(faults, source, validate)
    return described, tuple(faults)


def _described(root: Any, folder: Path, faults: list[Fault]) -> ModelDescription:
    major = int(root.get("fmiVersion")[0])
    judge_name(root, "modelName", faults)
    units, display_units = read_units(root, major, faults)
    reader = VariableReader(root, major, dict(read_types(root)), display_units, faults)
    variables = reader.variables()
    unknowns = tuple(read_unknowns(root, major, reader.numbered, faults))
    of_outputs = feedthrough(unknowns, "Output", variables)
    initial = feedthrough(unknowns, "InitialUnknown", variables)
    rates = [variables[u.variable] for u in unknowns if u.kind == "ContinuousStateDerivative"]
    indicators = [variables[u.variable] for u in unknowns if u.kind == "EventIndicator"]
    return ModelDescription(
        name=root.get("modelName", ""),
        fmi_version=root.get("fmiVersion"),
        token=root.get("instantiationToken" if major == 3 else "guid", ""),
        description=root.get("description", ""),
        generation_tool=root.get("generationTool", ""),
        co_simulation=capabilities(root, major, "CoSimulation", faults),
        model_exchange=capabilities(root, major, "ModelExchange", faults),
        scheduled_execution=capabilities(root, major, "ScheduledExecution", faults),
        variables=variables,
        units=units,
        feedthrough=direct_dependencies(root, variables) if major == 1 else of_outputs,
        states=tuple((v.derivative_of, v.name) for v in rates if v.derivative_of is not None),
        **experiment(root.find("DefaultExperiment"), faults),
        initial_feedthrough={n: names for n, names in initial.items() if names is not None},
        number_of_event_indicators=_count(root, "EventIndicators", indicators, faults),
        number_of_continuous_states=_count(root, "ContinuousStates", rates, faults),
        display_units=display_units,
        event_indicators=tuple(v.name for v in indicators),
        structured_names=root.get("variableNamingConvention") == "structured",
        unknowns=unknowns,
        terminals=tuple(read_terminals(folder, variables, faults)),
        layered_standards=tuple(read_layered_standards(folder, faults)),
    )


def _count(root: Any, what: str, unknowns: list[Variable], faults: list[Fault]) -> int:
    """How many states or event indicators there are, each element of an array one."""
    stated = {"1": ("ContinuousStates", "EventIndicators"), "2": ("EventIndicators",)}
    if what not in stated.get(root.get("fmiVersion")[0], ()):
        return sum(v.size for v in unknowns)
    count = integer(root.get(f"numberOf{what}")) or 0
    if not 0 <= count <= MAX_ELEMENTS:
        text = f"says numberOf{what}={count}; at most {MAX_ELEMENTS} can be held"
        faults.append(Fault(Harm.FORBIDDEN, text, root.sourceline or 0))
    return count
