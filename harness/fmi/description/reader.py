"""Reads an unpacked FMU's documents into a `ModelDescription`, with what is wrong with them.

The document is parsed once, held against the schema of the standard, and read; whatever the
numbers in it claim, nothing of their size is allocated, and those that cannot be meant (a step
size below 0, say) are left out and told.
"""

from __future__ import annotations

from pathlib import Path

from harness.fmi.description.additions import read_layered_standards, read_terminals
from harness.fmi.description.capabilities import capabilities, experiment, judge_name
from harness.fmi.description.definitions import read_types, read_units
from harness.fmi.description.document import Document, model_description_root, schema_faults
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
    document = Document(root, list(schema_faults(root)))
    described = _described(document, folder)
    document.faults.extend(circle_faults(described.variables))
    notes(document.faults, source, validate)
    return described, tuple(document.faults)


def _described(document: Document, folder: Path) -> ModelDescription:
    root, major = document.root, document.major
    judge_name(document, root, "modelName")
    units, display_units = read_units(document)
    reader = VariableReader(document, dict(read_types(root)), display_units)
    variables = reader.variables()
    unknowns = tuple(read_unknowns(document, reader.numbered))
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
        co_simulation=capabilities(document, "CoSimulation"),
        model_exchange=capabilities(document, "ModelExchange"),
        scheduled_execution=capabilities(document, "ScheduledExecution"),
        variables=variables,
        units=units,
        feedthrough=direct_dependencies(root, variables) if major == 1 else of_outputs,
        states=tuple((v.derivative_of, v.name) for v in rates if v.derivative_of is not None),
        **experiment(document),
        initial_feedthrough={n: names for n, names in initial.items() if names is not None},
        number_of_event_indicators=_count(document, "EventIndicators", indicators),
        number_of_continuous_states=_count(document, "ContinuousStates", rates),
        display_units=display_units,
        event_indicators=tuple(v.name for v in indicators),
        structured_names=root.get("variableNamingConvention") == "structured",
        unknowns=unknowns,
        terminals=tuple(read_terminals(folder, variables, document.faults)),
        layered_standards=tuple(read_layered_standards(folder, document.faults)),
    )


def _count(document: Document, what: str, unknowns: list[Variable]) -> int:
    """How many states or event indicators there are, each element of an array one."""
    if document.major == 3 or (document.major == 2 and what == "ContinuousStates"):
        return sum(v.size for v in unknowns)
    count = integer(document.root.get(f"numberOf{what}")) or 0
    if not 0 <= count <= MAX_ELEMENTS:
        text = f"says numberOf{what}={count}; at most {MAX_ELEMENTS} can be held"
        document.tell(document.root, text, Harm.FORBIDDEN)
    return count
