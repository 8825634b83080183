"""modelDescription.xml for FMI 2.0 and FMI 3.0: the parts that plants and blocks share."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree import ElementTree as ET

from fmus.declaration import DisplayUnit
from fmus.packaging.units import BaseUnit
from fmus.packaging.variables import ModelStructure, Unknown, VariableEntry

Attributes = dict[str, str]


def xml_bytes(root: ET.Element) -> bytes:
    """Indented UTF-8 with a declaration and a final newline."""
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()


def root_element(
    name: str, description: str, version: str, fmi_version: int, token: str
) -> ET.Element:
    """The root with its attributes."""
    attributes = {
        "fmiVersion": f"{fmi_version}.0",
        "modelName": name,
        "guid" if fmi_version == 2 else "instantiationToken": token,
        "description": description,
        "version": version,
        "license": "MIT",
        "generationTool": "fmu-harness",
        "variableNamingConvention": "structured",
    }
    if fmi_version == 2:
        attributes["numberOfEventIndicators"] = "0"
    return ET.Element("fmiModelDescription", attributes)


def unit_definitions(
    root: ET.Element,
    units: Mapping[str, BaseUnit | None],
    display_units: tuple[DisplayUnit, ...] = (),
) -> None:
    """Units by name; one whose meaning in base units is None is named only."""
    definitions = ET.SubElement(root, "UnitDefinitions")
    for unit, meaning in units.items():
        element = ET.SubElement(definitions, "Unit", name=unit)
        if meaning is not None:
            _base_unit(element, meaning)
        for display in display_units:
            if display.unit == unit:
                scale = {"name": display.name, "factor": repr(float(display.factor))}
                if display.offset:
                    scale["offset"] = repr(float(display.offset))
                ET.SubElement(element, "DisplayUnit", scale)


def _base_unit(element: ET.Element, meaning: BaseUnit) -> None:
    attributes = {base: str(power) for base, power in meaning.exponents.items()}
    if meaning.factor != 1.0:
        attributes["factor"] = repr(meaning.factor)
    if meaning.offset != 0.0:
        attributes["offset"] = repr(meaning.offset)
    ET.SubElement(element, "BaseUnit", attributes)


def log_categories(root: ET.Element, texts: Mapping[str, str]) -> None:
    """The log categories with their descriptions."""
    categories = ET.SubElement(root, "LogCategories")
    for name, text in texts.items():
        ET.SubElement(categories, "Category", name=name, description=text)


def _general(reference: int, entry: VariableEntry) -> Attributes:
    attributes = {"name": entry.name, "valueReference": str(reference)}
    if entry.description:
        attributes["description"] = entry.description
    attributes |= {"causality": entry.causality, "variability": entry.variability}
    if entry.initial is not None:
        attributes["initial"] = entry.initial
    return attributes


def _real(entry: VariableEntry, displays: dict[str, str]) -> Attributes:
    attributes = {"unit": entry.unit} if entry.unit else {}
    if entry.unit in displays:
        attributes["displayUnit"] = displays[entry.unit]
    if entry.minimum is not None:
        attributes["min"] = repr(float(entry.minimum))
    if entry.maximum is not None:
        attributes["max"] = repr(float(entry.maximum))
    if entry.nominal != 1.0:
        attributes["nominal"] = repr(float(entry.nominal))
    if entry.start is not None:
        attributes["start"] = repr(float(entry.start))
    return attributes


def add_variable(
    parent: ET.Element,
    fmi_version: int,
    reference: int,
    entry: VariableEntry,
    displays: dict[str, str],
) -> None:
    """One variable; `displays` is the display unit by unit."""
    add = _variable_2 if fmi_version == 2 else _variable_3
    add(parent, reference, entry, displays)


def _variable_2(
    parent: ET.Element, reference: int, entry: VariableEntry, displays: dict[str, str]
) -> None:
    real = _real(entry, displays)
    if entry.derivative_of is not None:
        real["derivative"] = str(entry.derivative_of + 1)  # an index, counted from 1
    element = ET.SubElement(parent, "ScalarVariable", _general(reference, entry))
    ET.SubElement(element, "Real", real)


def _variable_3(
    parent: ET.Element, reference: int, entry: VariableEntry, displays: dict[str, str]
) -> None:
    attributes = _general(reference, entry) | _real(entry, displays)
    if entry.derivative_of is not None:
        attributes["derivative"] = str(entry.derivative_of)
    ET.SubElement(parent, "Float64", attributes)


def _dependencies(unknown: Unknown, first: int) -> Attributes:
    return {
        "dependencies": " ".join(str(reference + first) for reference in unknown.dependencies),
        "dependenciesKind": " ".join(unknown.kinds),
    }


def add_structure(root: ET.Element, fmi_version: int, structure: ModelStructure) -> None:
    """The model structure."""
    add = _structure_2 if fmi_version == 2 else _structure_3
    add(ET.SubElement(root, "ModelStructure"), structure)


def _structure_2(parent: ET.Element, structure: ModelStructure) -> None:
    """FMI 2 counts variables from 1; a list without entries is left out."""
    for tag, unknowns in (
        ("Outputs", structure.outputs),
        ("Derivatives", structure.derivatives),
        ("InitialUnknowns", structure.initial_unknowns),
    ):
        if unknowns:
            group = ET.SubElement(parent, tag)
            for unknown in unknowns:
                index = {"index": str(unknown.reference + 1)}
                ET.SubElement(group, "Unknown", index | _dependencies(unknown, 1))


def _structure_3(parent: ET.Element, structure: ModelStructure) -> None:
    for tag, unknowns in (
        ("Output", structure.outputs),
        ("ContinuousStateDerivative", structure.derivatives),
        ("InitialUnknown", structure.initial_unknowns),
    ):
        for unknown in unknowns:
            reference = {"valueReference": str(unknown.reference)}
            ET.SubElement(parent, tag, reference | _dependencies(unknown, 0))
