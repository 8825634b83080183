"""modelDescription.xml of a plant's FMU.

Capabilities are declared where the runtime in `c/` has them and nowhere else. The token is a hash
of content and stands in for itself while it is computed (`archive.py`).
"""

from __future__ import annotations

from xml.etree import ElementTree as ET

from fmus.declaration import DisplayUnit, PlantModel
from fmus.packaging.c_source import MAIN_SOURCE
from fmus.packaging.model_description import (
    Attributes,
    add_structure,
    add_variable,
    log_categories,
    root_element,
    unit_definitions,
    xml_bytes,
)
from fmus.packaging.plant.interface import RELATIVE_TOLERANCE, Interface
from fmus.packaging.plant.variables import variable_entries
from fmus.packaging.units import base_unit
from fmus.packaging.variables import ModelStructure

LOG_CATEGORIES = {
    "logEvents": "Life cycle of the instance",
    "logSolver": "Substeps of each communication step",
    "logStatusWarning": "Warnings, always sent",
    "logStatusError": "Errors, always sent",
}


def model_description(
    interface: Interface,
    structure: ModelStructure,
    fmi_version: int,
    token: str,
    *,
    portable: bool = False,
) -> bytes:
    """The file's bytes, UTF-8, indented; `portable` declares what pythonfmu's library can do."""
    plant = interface.plant
    root = root_element(plant.name, plant.description, plant.version, fmi_version, token)
    entries = variable_entries(interface)
    if portable:
        _portable_interface(root, interface.plant.name, fmi_version)
    else:
        _interface_types(root, interface.plant.name, fmi_version)
    unit_definitions(root, {e.unit: base_unit(e.unit) for e in entries}, plant.display_units)
    log_categories(root, LOG_CATEGORIES)
    ET.SubElement(root, "DefaultExperiment", _experiment(interface.plant))
    displays = _display_names(interface.plant.display_units)
    variables = ET.SubElement(root, "ModelVariables")
    for reference, entry in enumerate(entries):
        add_variable(variables, fmi_version, reference, entry, displays)
    add_structure(root, fmi_version, structure)
    return xml_bytes(root)


def _interface_types(root: ET.Element, identifier: str, fmi_version: int) -> None:
    common = {"modelIdentifier": identifier}
    stepping = {"canHandleVariableCommunicationStepSize": "true", "maxOutputDerivativeOrder": "1"}
    if fmi_version == 3:
        common |= {
            "canGetAndSetFMUState": "true",
            "canSerializeFMUState": "true",
            "providesDirectionalDerivatives": "true",
            "providesAdjointDerivatives": "true",
        }
        ET.SubElement(root, "ModelExchange", common)
        ET.SubElement(root, "CoSimulation", common | stepping)
        return
    common |= {
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }
    for tag, attributes in (
        ("ModelExchange", common | {"completedIntegratorStepNotNeeded": "true"}),
        ("CoSimulation", common | stepping),
    ):
        files = ET.SubElement(ET.SubElement(root, tag, attributes), "SourceFiles")
        ET.SubElement(files, "File", name=MAIN_SOURCE)


def _portable_interface(root: ET.Element, identifier: str, fmi_version: int) -> None:
    attributes = {
        "modelIdentifier": identifier,
        "needsExecutionTool": "true",
        "canHandleVariableCommunicationStepSize": "true",
    }
    if fmi_version == 2:
        attributes["canNotUseMemoryManagementFunctions"] = "true"
    state = "FMUState" if fmi_version == 3 else "FMUstate"
    attributes |= {f"canGetAndSet{state}": "true", f"canSerialize{state}": "true"}
    ET.SubElement(root, "CoSimulation", attributes)


def _experiment(plant: PlantModel) -> Attributes:
    return {
        "startTime": "0",
        "stopTime": repr(float(plant.stop_time)),
        "tolerance": repr(RELATIVE_TOLERANCE),
        "stepSize": repr(float(plant.step_size)),
    }


def _display_names(display_units: tuple[DisplayUnit, ...]) -> dict[str, str]:
    """The display unit that variables of a unit are shown in: the first one given for it."""
    names: dict[str, str] = {}
    for display in display_units:
        names.setdefault(display.unit, display.name)
    return names
