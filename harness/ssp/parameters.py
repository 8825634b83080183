"""Parameter sets (SSV), parameter mappings (SSM) and signal dictionaries (SSB), as documents."""

from __future__ import annotations

from harness.ssp import common as ssc
from harness.ssp.binding import Element, wrapped


class ValueItem(Element, tags="ssv:Value"):
    """One of several strings."""

    value: str


class ParameterValue(ssc.Typed, tags=" ".join(f"ssv:{kind}" for kind in ssc.KINDS)):
    """A value as it stands in the document; numbers are several, separated by blanks, in an array.

    `items` are the strings of an array.
    """

    value: str | None = None
    items: tuple[ValueItem, ...] = ()


class Parameter(ssc.Entity, tags="ssv:Parameter"):
    """A named value of a parameter set."""

    name: str
    value: ParameterValue
    dimensions: tuple[ssc.Dimension, ...] = ()


class ParameterSet(ssc.TopLevel, tags="ssv:ParameterSet"):
    """An SSV document, or one inside a binding."""

    name: str
    parameters: tuple[Parameter, ...] = wrapped("Parameters", always=True)
    enumerations: tuple[ssc.Enumeration, ...] = wrapped("Enumerations")
    units: tuple[ssc.UnitDefinition, ...] = wrapped("Units")


class MappingEntry(ssc.Entity, tags="ssm:MappingEntry"):
    """The parameter `source` of the set goes to `target`, transformed."""

    source: str
    target: str
    suppress_unit_conversion: bool = False
    transformation: ssc.Transformation | None = None


class ParameterMapping(ssc.TopLevel, tags="ssm:ParameterMapping"):
    """An SSM document, or one inside a binding."""

    entries: tuple[MappingEntry, ...] = ()


class DictionaryEntry(ssc.Entity, tags="ssb:DictionaryEntry"):
    """A named signal of a dictionary."""

    name: str
    type: ssc.DataType
    dimensions: tuple[ssc.Dimension, ...] = ()


class Dictionary(ssc.TopLevel, tags="ssb:SignalDictionary"):
    """An SSB document, or one inside a system."""

    entries: tuple[DictionaryEntry, ...] = ()
    enumerations: tuple[ssc.Enumeration, ...] = wrapped("Enumerations")
    units: tuple[ssc.UnitDefinition, ...] = wrapped("Units")
