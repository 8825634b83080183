"""The units and the types that modelDescription.xml defines."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from harness.fmi.description.document import Document
from harness.fmi.description.faults import Harm, quoted
from harness.fmi.description.model_description import DisplayUnit
from harness.fmi.description.numbers import boolean, integer, real
from harness.fmi.wording import shorten
from harness.system.units import BASE_UNITS, Unit


def read_units(
    document: Document,
) -> tuple[dict[str, Unit], dict[str, dict[str, DisplayUnit]]]:
    """The units, and the display units of each by name."""
    units: dict[str, Unit] = {}
    shown: dict[str, dict[str, DisplayUnit]] = {}
    major = document.major
    for element in document.root.iterfind("UnitDefinitions/*"):
        name = str(element.get("unit" if major == 1 else "name"))
        base = element.find("BaseUnit") if major > 1 else None
        units[name] = Unit(name)
        if base is not None:
            exponents = tuple(integer(base.get(one)) or 0 for one in BASE_UNITS)
            factor, offset = _conversion(base, "factor", f"unit {quoted(name)}", document)
            units[name] = Unit(name, exponents, factor, offset)
        of_unit = shown.setdefault(name, {})
        for one in element.iterchildren("*"):
            if one.tag in ("DisplayUnit", "DisplayUnitDefinition"):
                label = str(one.get("displayUnit" if major == 1 else "name"))
                what, gain = f"display unit {quoted(label)}", "gain" if major == 1 else "factor"
                numbers = _conversion(one, gain, what, document)
                of_unit[label] = DisplayUnit(*numbers, boolean(one.get("inverse")))
    return units, shown


def _conversion(element: Any, gain: str, what: str, document: Document) -> tuple[float, float]:
    """Factor and offset; a factor of 0 or one that is not finite converts nothing."""
    factor, offset = real(element.get(gain, "1")), real(element.get("offset", "0"))
    if factor and math.isfinite(factor) and offset is not None and math.isfinite(offset):
        return factor, offset
    shown = f"factor {element.get(gain, '1')} and offset {element.get('offset', '0')}"
    text = f"has the {what} with {shorten(shown)}, by which nothing can be converted"
    document.tell(element, text, Harm.AMBIGUOUS)
    return 1.0, 0.0


def read_types(root: Any) -> Iterator[tuple[str, dict[str, Any]]]:
    """Attributes of declared types by name; "items" are those of enumerations."""
    for element in root.iterfind("TypeDefinitions/*"):
        inner = element
        if element.tag in ("Type", "SimpleType"):
            inner = next(element.iterchildren("*"), element)
        attributes: dict[str, Any] = dict(inner.attrib)
        items = enumerate(inner.iterchildren("Item"), start=1)
        numbers = ((integer(item.get("value", str(place))), item) for place, item in items)
        attributes["items"] = tuple(
            (number, str(item.get("name"))) for number, item in numbers if number is not None
        )
        yield str(element.get("name")), attributes
