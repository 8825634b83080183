"""modelDescription.xml of a block: co-simulation, one sample clock, no feedthrough.

Outputs change during a step only, so at a communication point they depend on no input, and the
model structure says so.
"""

from __future__ import annotations

from xml.etree import ElementTree as ET

from fmus.packaging.block.interface import BlockModel, block_entries
from fmus.packaging.errors import PackagingError
from fmus.packaging.model_description import (
    add_structure,
    add_variable,
    log_categories,
    root_element,
    unit_definitions,
    xml_bytes,
)
from fmus.packaging.units import BaseUnit, base_unit
from fmus.packaging.variables import ModelStructure, Unknown

LOG_CATEGORIES = {
    "logEvents": "Life cycle of the instance",
    "logSolver": "Samples computed in each communication step",
    "logStatusWarning": "Warnings, always sent",
    "logStatusError": "Errors, always sent",
}


def block_description(
    model: BlockModel, fmi_version: int, token: str, *, portable: bool = False
) -> bytes:
    """The file's bytes, UTF-8, indented; `portable` says that it needs Python."""
    root = root_element(
        model.name, f"{model.description} {timing(model)}", model.version, fmi_version, token
    )
    _interface_type(root, model, fmi_version, portable)
    entries = block_entries(model)
    unit_definitions(root, {e.unit: _meaning(e.unit) for e in entries if e.unit})
    log_categories(root, LOG_CATEGORIES)
    ET.SubElement(root, "DefaultExperiment", _experiment(model))
    variables = ET.SubElement(root, "ModelVariables")
    for reference, entry in enumerate(entries):
        add_variable(variables, fmi_version, reference, entry, {})
    first = 1 + len(model.inputs)
    outputs = tuple(Unknown(first + i, (), ()) for i in range(len(model.outputs)))
    add_structure(root, fmi_version, ModelStructure(outputs, (), ()))
    return xml_bytes(root)


def timing(model: BlockModel) -> str:
    """When the block computes, and what that means in a system."""
    phase = f", the first at {_seconds(model.phase_ns)} s" if model.phase_ns else ""
    return (
        f"Computes every {_seconds(model.sample_time_ns)} s{phase}: a step from t computes the "
        "samples due from t on, with the inputs set at t, and holds the outputs. Step it before "
        "the plant and pass the outputs on for the same step: no delay. Where all FMUs step at "
        "once, the outputs arrive one communication step later."
    )


def _interface_type(root: ET.Element, model: BlockModel, fmi_version: int, portable: bool) -> None:
    attributes = {
        "modelIdentifier": model.name,
        "canHandleVariableCommunicationStepSize": "true",
    }
    if fmi_version == 3:
        attributes |= {"canGetAndSetFMUState": "true", "canSerializeFMUState": "true"}
        attributes["fixedInternalStepSize"] = _seconds(model.sample_time_ns)
    else:
        attributes |= {
            "canNotUseMemoryManagementFunctions": "true",
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
        }
    if portable:
        attributes["needsExecutionTool"] = "true"
    ET.SubElement(root, "CoSimulation", attributes)


def _experiment(model: BlockModel) -> dict[str, str]:
    """A hundred samples; a tolerance is taken and not used, as nothing is integrated."""
    stop = model.phase_ns + 100 * model.sample_time_ns
    return {
        "startTime": "0",
        "stopTime": _seconds(stop),
        "tolerance": "0.0001",
        "stepSize": _seconds(model.sample_time_ns),
    }


def _seconds(nanoseconds: int) -> str:
    return repr(nanoseconds / 1e9)


def _meaning(unit: str) -> BaseUnit | None:
    """The unit in base units, None for one that only its author knows."""
    try:
        return base_unit(unit)
    except PackagingError:
        return None
