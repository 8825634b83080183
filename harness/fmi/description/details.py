"""What stands in modelDescription.xml and FMPy 0.3.32 does not read, or reads wrongly.

Aliases of FMI 1 with their sign, the intervals of clocks, start values of arrays of strings and
binaries, relative quantities, enumeration items, display units, and the capabilities of FMI 1.
This module refuses to judge: the document has been validated before.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

_TRUE = ("true", "1")


@dataclass(frozen=True)
class DisplayUnit:
    """display value = `factor` * value + `offset`; where `inverse`, `factor` / value."""

    factor: float = 1.0
    offset: float = 0.0
    inverse: bool = False


@dataclass(frozen=True)
class Details:
    """What only some variables have.

    `alias_of`: the variable of which this is another name; `negated`: with the opposite sign
    (FMI 1). `relative`: a difference, such as of temperatures, whose unit conversion has no offset.
    `starts`: the start values of an array of strings or binaries. `items`: names of an
    enumeration by number. For clocks: `interval_variability`, `interval` and `shift` (s, as the
    fraction counter over resolution where given so), `can_be_deactivated`. `clocks`: the clocks
    of a clocked variable, by name.
    """

    alias_of: str | None = None
    negated: bool = False
    relative: bool = False
    display_unit: str | None = None
    declared_type: str | None = None
    starts: tuple[str, ...] = ()
    items: tuple[tuple[int, str], ...] = ()
    interval_variability: str | None = None
    interval: tuple[int, int] | float | None = None
    shift: tuple[int, int] | float = 0.0
    can_be_deactivated: bool = False
    clocks: tuple[str, ...] = ()
    has_start: bool = True
    multiple_sets: bool = True


def read_details(root: Any) -> dict[str, Details]:
    """Details by variable name, for the variables and the aliases of FMI 3."""
    types = dict(_types(root))
    found: dict[str, Details] = {}
    bases: dict[tuple[str, str], str] = {}
    for element in _elements(root.find("ModelVariables")):
        value = _value_element(element)
        name = str(element.get("name"))
        details = _details(element, value, types.get(value.get("declaredType", ""), {}))
        if element.get("alias") in ("alias", "negatedAlias"):  # FMI 1
            key = (str(value.tag), str(element.get("valueReference")))
            details = Details(
                **(vars(details) | {"alias_of": bases.get(key)}),
            )
        else:
            bases.setdefault((str(value.tag), str(element.get("valueReference"))), name)
        found[name] = details
        for alias in element.findall("Alias"):
            found[str(alias.get("name"))] = Details(
                **(vars(details) | {"display_unit": alias.get("displayUnit")})
            )
    return found


def _details(element: Any, value: Any, declared: Mapping[str, Any]) -> Details:
    relative = value.get("relativeQuantity", declared.get("relativeQuantity", "false"))
    return Details(
        negated=element.get("alias") == "negatedAlias",
        relative=relative in _TRUE,
        display_unit=value.get("displayUnit", declared.get("displayUnit")),
        declared_type=value.get("declaredType"),
        starts=tuple(str(start.get("value")) for start in element.findall("Start")),
        items=declared.get("items", ()),
        interval_variability=value.get("intervalVariability"),
        interval=_duration(value, "interval"),
        shift=_duration(value, "shift") or 0.0,
        can_be_deactivated=value.get("canBeDeactivated") in _TRUE,
        clocks=tuple((element.get("clocks") or "").split()),
        has_start=value.get("start") is not None or element.find("Start") is not None,
        multiple_sets=element.get("canHandleMultipleSetPerTimeInstant", "true") in _TRUE,
    )


def _duration(value: Any, what: str) -> tuple[int, int] | float | None:
    decimal, counter = value.get(f"{what}Decimal"), value.get(f"{what}Counter")
    if decimal is not None:
        return float(decimal)
    if counter is not None and value.get("resolution") is not None:
        return int(counter), int(value.get("resolution"))
    return None


def _value_element(element: Any) -> Any:
    """Where the attributes of the type are: the variable itself in FMI 3, a child before."""
    for child in _elements(element):
        if child.tag in ("Real", "Integer", "Boolean", "String", "Enumeration"):
            return child
    return element


def _types(root: Any) -> Iterator[tuple[str, dict[str, Any]]]:
    for element in _elements(root.find("TypeDefinitions")):
        children = list(_elements(element))
        inner = children[0] if element.tag in ("Type", "SimpleType") and children else element
        attributes: dict[str, Any] = dict(inner.attrib)
        attributes["items"] = tuple(
            (int(item.get("value", position)), str(item.get("name")))
            for position, item in enumerate(inner.findall("Item"), start=1)
        )
        yield str(element.get("name")), attributes


def read_display_units(root: Any) -> dict[str, dict[str, DisplayUnit]]:
    """Display units by unit and name, of all versions."""
    found: dict[str, dict[str, DisplayUnit]] = {}
    for unit in _elements(root.find("UnitDefinitions")):
        shown = found.setdefault(str(unit.get("unit") or unit.get("name")), {})
        for one in unit.findall("DisplayUnitDefinition"):  # FMI 1 has a gain, the others a factor
            shown[str(one.get("displayUnit"))] = DisplayUnit(
                float(one.get("gain", "1")), float(one.get("offset", "0"))
            )
        for one in unit.findall("DisplayUnit"):
            shown[str(one.get("name"))] = DisplayUnit(
                float(one.get("factor", "1")),
                float(one.get("offset", "0")),
                one.get("inverse") in _TRUE,
            )
    return found


def fmi1_capabilities(root: Any) -> dict[str, Any] | None:
    """What an FMI 1 FMU for co-simulation states of itself, as fields of `Capabilities`."""
    if root.get("fmiVersion") != "1.0":
        return None
    for element in root.iterfind("Implementation//Capabilities"):
        return {
            "can_handle_variable_step": (
                element.get("canHandleVariableCommunicationStepSize") in _TRUE
            ),
            "can_be_instantiated_only_once": (
                element.get("canBeInstantiatedOnlyOncePerProcess") in _TRUE
            ),
            "max_output_derivative_order": int(element.get("maxOutputDerivativeOrder", "0")),
            "needs_execution_tool": root.find("Implementation/CoSimulation_Tool") is not None,
        }
    return {}


def _elements(parent: Any) -> Iterator[Any]:
    """Child elements without comments and processing instructions."""
    if parent is not None:
        yield from parent.iterchildren("*")
