"""Parameter sets (SSV), parameter mappings (SSM) and signal dictionaries (SSB), as documents."""

from __future__ import annotations

from harness.ssp.binding import Element, wrapped
from harness.ssp.common import (
    KINDS,
    DataType,
    Dimension,
    Entity,
    Enumeration,
    TopLevel,
    Transformation,
    Typed,
    UnitDefinition,
)


class ValueItem(Element, tags="ssv:Value"):
    """One of several strings."""

    value: str


class ParameterValue(Typed, tags=" ".join(f"ssv:{kind}" for kind in KINDS)):
    """A value as it stands in the document; numbers are several, separated by blanks, in an array.

    `items` are the strings of an array.
    """

    value: str | None = None
    items: tuple[ValueItem, ...] = ()


class Parameter(Entity, tags="ssv:Parameter"):
    """A named value of a parameter set."""

    name: str
    value: ParameterValue
    dimensions: tuple[Dimension, ...] = ()


class ParameterSet(TopLevel, tags="ssv:ParameterSet"):
    """An SSV document, or one inside a binding."""

    name: str
    parameters: tuple[Parameter, ...] = wrapped("Parameters", always=True)
    enumerations: tuple[Enumeration, ...] = wrapped("Enumerations")
    units: tuple[UnitDefinition, ...] = wrapped("Units")


class MappingEntry(Entity, tags="ssm:MappingEntry"):
    """The parameter `source` of the set goes to `target`, transformed."""

    source: str
    target: str
    suppress_unit_conversion: bool = False
    transformation: Transformation | None = None


class ParameterMapping(TopLevel, tags="ssm:ParameterMapping"):
    """An SSM document, or one inside a binding."""

    entries: tuple[MappingEntry, ...] = ()


class DictionaryEntry(Entity, tags="ssb:DictionaryEntry"):
    """A named signal of a dictionary."""

    name: str
    type: DataType
    dimensions: tuple[Dimension, ...] = ()


class Dictionary(TopLevel, tags="ssb:SignalDictionary"):
    """An SSB document, or one inside a system."""

    entries: tuple[DictionaryEntry, ...] = ()
    enumerations: tuple[Enumeration, ...] = wrapped("Enumerations")
    units: tuple[UnitDefinition, ...] = wrapped("Units")
