"""Parameter sets (SSV), parameter mappings (SSM) and signal dictionaries (SSB), as documents."""

from __future__ import annotations

from dataclasses import dataclass

from harness.ssp.binding import Element, attribute, child, children
from harness.ssp.common import (
    KINDS,
    VERSIONS,
    Annotation,
    Base,
    DataType,
    Dimension,
    Enumeration,
    LinearTransformation,
    MappingTransformation,
    TopLevel,
    Transformation,
    UnitDefinition,
    metadata,
)


@dataclass(frozen=True, kw_only=True)
class ValueItem(Element):
    """One of several strings."""

    TAGS = ("ssv:Value",)
    value: str = attribute()


@dataclass(frozen=True, kw_only=True)
class ParameterValue(Element):
    """A value as it stands in the document; numbers are several, separated by blanks, in an array.

    `name` is that of the enumeration, `items` are the strings of an array.
    """

    TAGS = tuple(f"ssv:{kind}" for kind in KINDS)
    value: str | None = attribute(default=None)
    unit: str | None = attribute(default=None)
    name: str | None = attribute(default=None)
    mime_type: str | None = attribute("mime-type", default=None)
    items: tuple[ValueItem, ...] = children(lambda: (ValueItem,))

    @property
    def kind(self) -> str:
        """Such as "Real" or "Enumeration"."""
        return self.tag.partition(":")[2]


@dataclass(frozen=True, kw_only=True)
class Parameter(Base):
    """A named value of a parameter set."""

    TAGS = ("ssv:Parameter",)
    name: str = attribute()
    value: ParameterValue = child(ParameterValue, optional=False)
    dimensions: tuple[Dimension, ...] = children(lambda: (Dimension,))
    annotations: tuple[Annotation, ...] = children(lambda: (Annotation,), wrapper="ssv:Annotations")


@dataclass(frozen=True, kw_only=True)
class ParameterSet(TopLevel):
    """An SSV document, or one inside a binding."""

    TAGS = ("ssv:ParameterSet",)
    version: str = attribute(choices=VERSIONS)
    name: str = attribute()
    parameters: tuple[Parameter, ...] = children(
        lambda: (Parameter,), wrapper="ssv:Parameters", always=True
    )
    enumerations: tuple[Enumeration, ...] = children(
        lambda: (Enumeration,), wrapper="ssv:Enumerations"
    )
    units: tuple[UnitDefinition, ...] = children(lambda: (UnitDefinition,), wrapper="ssv:Units")
    metadata: tuple[str, ...] = metadata()
    annotations: tuple[Annotation, ...] = children(lambda: (Annotation,), wrapper="ssv:Annotations")


@dataclass(frozen=True, kw_only=True)
class MappingEntry(Base):
    """The parameter `source` of the set goes to `target`, transformed."""

    TAGS = ("ssm:MappingEntry",)
    source: str = attribute()
    target: str = attribute()
    suppress_unit_conversion: bool = attribute("suppressUnitConversion", "boolean", default=False)
    transformation: Transformation | None = child(LinearTransformation, MappingTransformation)
    annotations: tuple[Annotation, ...] = children(lambda: (Annotation,), wrapper="ssm:Annotations")


@dataclass(frozen=True, kw_only=True)
class ParameterMapping(TopLevel):
    """An SSM document, or one inside a binding."""

    TAGS = ("ssm:ParameterMapping",)
    version: str = attribute(choices=VERSIONS)
    entries: tuple[MappingEntry, ...] = children(lambda: (MappingEntry,))
    metadata: tuple[str, ...] = metadata()
    annotations: tuple[Annotation, ...] = children(lambda: (Annotation,), wrapper="ssm:Annotations")


@dataclass(frozen=True, kw_only=True)
class DictionaryEntry(Base):
    """A named signal of a dictionary."""

    TAGS = ("ssb:DictionaryEntry",)
    name: str = attribute()
    type: DataType = child(DataType, optional=False)
    dimensions: tuple[Dimension, ...] = children(lambda: (Dimension,))
    annotations: tuple[Annotation, ...] = children(lambda: (Annotation,), wrapper="ssb:Annotations")


@dataclass(frozen=True, kw_only=True)
class Dictionary(TopLevel):
    """An SSB document, or one inside a system."""

    TAGS = ("ssb:SignalDictionary",)
    version: str = attribute(choices=VERSIONS)
    entries: tuple[DictionaryEntry, ...] = children(lambda: (DictionaryEntry,))
    enumerations: tuple[Enumeration, ...] = children(
        lambda: (Enumeration,), wrapper="ssb:Enumerations"
    )
    units: tuple[UnitDefinition, ...] = children(lambda: (UnitDefinition,), wrapper="ssb:Units")
    metadata: tuple[str, ...] = metadata()
    annotations: tuple[Annotation, ...] = children(lambda: (Annotation,), wrapper="ssb:Annotations")
