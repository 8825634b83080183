"""What all SSP documents share: units, enumerations, annotations, types and transformations."""

from __future__ import annotations

from typing import Annotated

from harness.ssp.binding import Element, attribute, text, verbatim, wrapped

INTEGER_KINDS = (
    "Integer", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64",
)  # fmt: skip
KINDS: dict[str, type] = {
    **dict.fromkeys(("Real", "Float64", "Float32"), float),
    **dict.fromkeys(INTEGER_KINDS, int),
    "Boolean": bool,
    **dict.fromkeys(("String", "Enumeration", "Binary"), str),
}
"""The kinds of types with what a value of each is in Python."""
Version = Annotated[str, ("1.0", "2.0")]


class Annotation(Element, tags="ssc:Annotation"):
    """What a tool adds under its own reverse-domain `type`; `more` holds its content."""

    type: str
    text: str = text()


class Base(Element):
    """What every entity of a document may have."""

    id: str | None = None
    description: str | None = None


class Entity(Base):
    """An entity that may have annotations besides."""

    annotations: tuple[Annotation, ...] = wrapped("Annotations", last=True)


class TopLevel(Base):
    """What the root of every document says of itself."""

    version: Version
    author: str | None = None
    fileversion: str | None = None
    copyright: str | None = None
    license: str | None = None
    generation_tool: str | None = None
    generation_date_and_time: str | None = None
    metadata: tuple[str, ...] = verbatim("ssc:MetaData", "ssc:Signature", last=True)
    annotations: tuple[Annotation, ...] = wrapped("Annotations", last=True)


class BaseUnit(Element, tags="ssc:BaseUnit"):
    """Exponents of the SI base units; base value = factor · value + offset."""

    kg: int = 0
    m: int = 0
    s: int = 0
    A: int = 0
    K: int = 0
    mol: int = 0
    cd: int = 0
    rad: int = 0
    factor: float = 1.0
    offset: float = 0.0


class UnitDefinition(Entity, tags="ssc:Unit"):
    """A unit that the document may name."""

    name: str
    base: BaseUnit


class Item(Element, tags="ssc:Item"):
    """One value of an enumeration."""

    name: str
    value: int


class Enumeration(Entity, tags="ssc:Enumeration"):
    """An enumeration that the document may name."""

    name: str
    items: tuple[Item, ...] = ()


class Typed(Element):
    """A type of the kind that the tag says; `name` is that of the enumeration."""

    unit: str | None = None
    name: str | None = None
    mime_type: str | None = attribute("mime-type", default=None)

    @property
    def kind(self) -> str:
        """Such as "Real" or "Enumeration"."""
        return self.tag.partition(":")[2]


class DataType(Typed, tags=" ".join(f"ssc:{kind}" for kind in (*KINDS, "Clock"))):
    """The type of a connector or dictionary entry."""


class Dimension(Element, tags="ssc:Dimension"):
    """One dimension of an array."""

    size: int | None = None
    size_connector: str | None = None


class MapEntry(Element, tags="ssc:MapEntry"):
    """One line of a mapping transformation."""

    source: str
    target: str


class LinearTransformation(Element, tags="ssc:LinearTransformation"):
    """target = factor · source + offset, after the conversion of units.

    Both numbers are always written: ecos takes a factor that is not there for zero.
    """

    factor: float = attribute(default=1.0, always=True)
    offset: float = attribute(default=0.0, always=True)


class MappingTransformation(
    Element,
    tags="ssc:BooleanMappingTransformation ssc:IntegerMappingTransformation "
    "ssc:EnumerationMappingTransformation",
):
    """A table of values, of the kind that the tag says; what it does not name stays."""

    entries: tuple[MapEntry, ...] = ()


Transformation = LinearTransformation | MappingTransformation
