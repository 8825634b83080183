"""What all SSP documents share: units, enumerations, annotations, types and transformations."""

from __future__ import annotations

from dataclasses import dataclass

from harness.ssp.binding import Element, as_it_is, attribute, child, children, text

VERSIONS = ("1.0", "2.0")
INTEGER_KINDS = (
    "Integer", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64",
)  # fmt: skip
REAL_KINDS = ("Real", "Float64", "Float32")
KINDS = (*REAL_KINDS, *INTEGER_KINDS, "Boolean", "String", "Enumeration", "Binary")
FIRST_KINDS = ("Real", "Integer", "Boolean", "String", "Enumeration", "Binary")
"""The types that SSP 1.0 knows."""


@dataclass(frozen=True, kw_only=True)
class Annotation(Element):
    """What a tool adds under its own reverse-domain `type`; `more` holds its content."""

    TAGS = ("ssc:Annotation",)
    type: str = attribute()
    text: str = text()


@dataclass(frozen=True, kw_only=True)
class Base(Element):
    """What every entity of a document may have."""

    id: str | None = attribute(default=None)
    description: str | None = attribute(default=None)


@dataclass(frozen=True, kw_only=True)
class TopLevel(Base):
    """What the root of every document may say of itself."""

    author: str | None = attribute(default=None)
    fileversion: str | None = attribute(default=None)
    copyright: str | None = attribute(default=None)
    license: str | None = attribute(default=None)
    generation_tool: str | None = attribute("generationTool", default=None)
    generation_time: str | None = attribute("generationDateAndTime", default=None)


@dataclass(frozen=True, kw_only=True)
class BaseUnit(Element):
    """Exponents of the SI base units; base value = factor · value + offset."""

    TAGS = ("ssc:BaseUnit",)
    kg: int = attribute(form="integer", default=0)
    m: int = attribute(form="integer", default=0)
    s: int = attribute(form="integer", default=0)
    A: int = attribute(form="integer", default=0)
    K: int = attribute(form="integer", default=0)
    mol: int = attribute(form="integer", default=0)
    cd: int = attribute(form="integer", default=0)
    rad: int = attribute(form="integer", default=0)
    factor: float = attribute(form="double", default=1.0)
    offset: float = attribute(form="double", default=0.0)


@dataclass(frozen=True, kw_only=True)
class UnitDefinition(Base):
    """A unit that the document may name."""

    TAGS = ("ssc:Unit",)
    name: str = attribute()
    base: BaseUnit = child(BaseUnit, optional=False)
    annotations: tuple[Annotation, ...] = children(lambda: (Annotation,), wrapper="ssc:Annotations")


@dataclass(frozen=True, kw_only=True)
class Item(Element):
    """One value of an enumeration."""

    TAGS = ("ssc:Item",)
    name: str = attribute()
    value: int = attribute(form="integer")


@dataclass(frozen=True, kw_only=True)
class Enumeration(Base):
    """An enumeration that the document may name."""

    TAGS = ("ssc:Enumeration",)
    name: str = attribute()
    items: tuple[Item, ...] = children(lambda: (Item,))
    annotations: tuple[Annotation, ...] = children(lambda: (Annotation,), wrapper="ssc:Annotations")


@dataclass(frozen=True, kw_only=True)
class DataType(Element):
    """The type of a connector or dictionary entry; `name` is that of the enumeration."""

    TAGS = tuple(f"ssc:{kind}" for kind in (*KINDS, "Clock"))
    unit: str | None = attribute(default=None)
    name: str | None = attribute(default=None)
    mime_type: str | None = attribute("mime-type", default=None)

    @property
    def kind(self) -> str:
        """Such as "Real" or "Enumeration"."""
        return self.tag.partition(":")[2]


@dataclass(frozen=True, kw_only=True)
class Dimension(Element):
    """One dimension of an array."""

    TAGS = ("ssc:Dimension",)
    size: int | None = attribute(form="integer", default=None)
    size_connector: str | None = attribute("sizeConnector", default=None)


@dataclass(frozen=True, kw_only=True)
class MapEntry(Element):
    """One line of a mapping transformation."""

    TAGS = ("ssc:MapEntry",)
    source: str = attribute()
    target: str = attribute()


@dataclass(frozen=True, kw_only=True)
class LinearTransformation(Element):
    """target = factor · source + offset, after the conversion of units.

    Both numbers are always written: ecos takes a factor that is not there for zero.
    """

    TAGS = ("ssc:LinearTransformation",)
    factor: float = attribute(form="double", default=1.0, always=True)
    offset: float = attribute(form="double", default=0.0, always=True)


@dataclass(frozen=True, kw_only=True)
class MappingTransformation(Element):
    """A table of values, of the kind that the tag says; what it does not name stays."""

    TAGS = (
        "ssc:BooleanMappingTransformation",
        "ssc:IntegerMappingTransformation",
        "ssc:EnumerationMappingTransformation",
    )
    entries: tuple[MapEntry, ...] = children(lambda: (MapEntry,))


Transformation = LinearTransformation | MappingTransformation


def metadata() -> tuple[str, ...]:
    """Meta data and signatures, which are kept and not read."""
    kept: tuple[str, ...] = as_it_is("ssc:MetaData", "ssc:Signature")
    return kept
