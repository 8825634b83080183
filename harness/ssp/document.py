"""A System Structure Description (SSD) as frozen dataclasses, in the order of its schema.

Geometry, notes, meta data and signatures are kept as they are; the rest has a meaning here.
Nothing is resolved, opened or judged beyond its form.
"""

from __future__ import annotations

from dataclasses import dataclass

from harness.ssp.binding import Element, as_it_is, attribute, child, children
from harness.ssp.common import (
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
from harness.ssp.parameters import Dictionary, ParameterMapping, ParameterSet

FMU_TYPE = "application/x-fmu-sharedlibrary"
SSD_TYPE = "application/x-ssp-definition"
SSP_TYPE = "application/x-ssp-package"
PARAMETER_SET_TYPE = "application/x-ssp-parameter-set"
MAPPING_TYPE = "application/x-ssp-parameter-mapping"
DICTIONARY_TYPE = "application/x-ssp-signal-dictionary"
_BASES = ("SSD", "component")
CONNECTOR_KINDS = (
    "input", "output", "parameter", "calculatedParameter", "structuralParameter", "constant",
    "local", "inout", "unspecified",
)  # fmt: skip


def _annotations() -> tuple[Annotation, ...]:
    made: tuple[Annotation, ...] = children(lambda: (Annotation,), wrapper="ssd:Annotations")
    return made


@dataclass(frozen=True, kw_only=True)
class Connector(Base):
    """A port of a system or component."""

    TAGS = ("ssd:Connector",)
    name: str = attribute()
    kind: str = attribute(choices=CONNECTOR_KINDS)
    type: DataType | None = child(DataType)
    dimensions: tuple[Dimension, ...] = children(lambda: (Dimension,))
    geometry: tuple[str, ...] = as_it_is("ssd:Clock", "ssd:ConnectorGeometry")
    annotations: tuple[Annotation, ...] = _annotations()


@dataclass(frozen=True, kw_only=True)
class MappingReference(Base):
    """A parameter mapping, inline or by `source`."""

    TAGS = ("ssd:ParameterMapping",)
    type: str = attribute(default=MAPPING_TYPE)
    source: str | None = attribute(default=None)
    source_base: str = attribute("sourceBase", choices=_BASES, default="SSD")
    inline: ParameterMapping | None = child(ParameterMapping)


@dataclass(frozen=True, kw_only=True)
class ParameterBinding(Base):
    """A parameter set, inline or by `source`, given to an element."""

    TAGS = ("ssd:ParameterBinding",)
    type: str = attribute(default=PARAMETER_SET_TYPE)
    source: str | None = attribute(default=None)
    source_base: str = attribute("sourceBase", choices=_BASES, default="SSD")
    prefix: str = attribute(default="")
    values: ParameterSet | None = child(ParameterSet, wrapper="ssd:ParameterValues")
    mapping: MappingReference | None = child(MappingReference)
    metadata: tuple[str, ...] = metadata()
    annotations: tuple[Annotation, ...] = _annotations()


@dataclass(frozen=True, kw_only=True)
class ModelElement(Base):
    """What systems, components and dictionary references have in common."""

    name: str = attribute()
    connectors: tuple[Connector, ...] = children(lambda: (Connector,), wrapper="ssd:Connectors")
    geometry: tuple[str, ...] = as_it_is("ssd:ElementGeometry")
    bindings: tuple[ParameterBinding, ...] = children(
        lambda: (ParameterBinding,), wrapper="ssd:ParameterBindings"
    )
    metadata: tuple[str, ...] = metadata()

    def connector(self, name: str) -> Connector | None:
        """The connector of that name, if it is declared."""
        return next((one for one in self.connectors if one.name == name), None)


@dataclass(frozen=True, kw_only=True)
class Component(ModelElement):
    """An FMU, or another system description, named by `source`."""

    TAGS = ("ssd:Component",)
    type: str = attribute(default=FMU_TYPE)
    source: str | None = attribute(default=None)
    implementation: str = attribute(
        choices=("any", "ModelExchange", "CoSimulation", "ScheduledExecution"), default="any"
    )
    annotations: tuple[Annotation, ...] = _annotations()


@dataclass(frozen=True, kw_only=True)
class DictionaryReference(ModelElement):
    """Gives a system access to the signals of a dictionary of this or an enclosing system."""

    TAGS = ("ssd:SignalDictionaryReference",)
    dictionary: str = attribute()
    annotations: tuple[Annotation, ...] = _annotations()


@dataclass(frozen=True, kw_only=True)
class Connection(Base):
    """A wire between connectors of a system (no element) and of its elements."""

    TAGS = ("ssd:Connection",)
    start_element: str | None = attribute("startElement", default=None)
    start_connector: str = attribute("startConnector")
    start_indices: tuple[str, ...] = attribute("startIndices", "list", default=())
    end_element: str | None = attribute("endElement", default=None)
    end_connector: str = attribute("endConnector")
    end_indices: tuple[str, ...] = attribute("endIndices", "list", default=())
    suppress_unit_conversion: bool = attribute("suppressUnitConversion", "boolean", default=False)
    transformation: Transformation | None = child(LinearTransformation, MappingTransformation)
    geometry: tuple[str, ...] = as_it_is("ssd:ConnectionGeometry")
    annotations: tuple[Annotation, ...] = _annotations()


@dataclass(frozen=True, kw_only=True)
class DictionaryDefinition(Base):
    """A signal dictionary, inline or by `source`."""

    TAGS = ("ssd:SignalDictionary",)
    name: str = attribute()
    type: str = attribute(default=DICTIONARY_TYPE)
    source: str | None = attribute(default=None)
    inline: Dictionary | None = child(Dictionary)


@dataclass(frozen=True, kw_only=True)
class SystemElement(ModelElement):
    """A system: elements, and the connections between their and its own connectors."""

    TAGS = ("ssd:System",)
    elements: tuple[Component | DictionaryReference | SystemElement, ...] = children(
        lambda: (Component, DictionaryReference, SystemElement), wrapper="ssd:Elements"
    )
    connections: tuple[Connection, ...] = children(lambda: (Connection,), wrapper="ssd:Connections")
    dictionaries: tuple[DictionaryDefinition, ...] = children(
        lambda: (DictionaryDefinition,), wrapper="ssd:SignalDictionaries"
    )
    graphics: tuple[str, ...] = as_it_is("ssd:SystemGeometry", "ssd:GraphicalElements")
    annotations: tuple[Annotation, ...] = _annotations()


@dataclass(frozen=True, kw_only=True)
class DefaultExperiment(Element):
    """Start and stop time (s), for information."""

    TAGS = ("ssd:DefaultExperiment",)
    start_time: float | None = attribute("startTime", "double", default=None)
    stop_time: float | None = attribute("stopTime", "double", default=None)
    annotations: tuple[Annotation, ...] = _annotations()


@dataclass(frozen=True, kw_only=True)
class SystemStructure(TopLevel):
    """An SSD document."""

    TAGS = ("ssd:SystemStructureDescription",)
    version: str = attribute(choices=VERSIONS)
    name: str = attribute()
    system: SystemElement = child(SystemElement, optional=False)
    enumerations: tuple[Enumeration, ...] = children(
        lambda: (Enumeration,), wrapper="ssd:Enumerations"
    )
    units: tuple[UnitDefinition, ...] = children(lambda: (UnitDefinition,), wrapper="ssd:Units")
    experiment: DefaultExperiment | None = child(DefaultExperiment)
    metadata: tuple[str, ...] = metadata()
    annotations: tuple[Annotation, ...] = _annotations()
