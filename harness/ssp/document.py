"""A System Structure Description (SSD) as frozen dataclasses, in the order of its schema.

Geometry, notes, meta data and signatures go through unread; the rest has a meaning here.
Nothing is resolved, opened or judged beyond its form.
"""

from __future__ import annotations

from typing import Annotated

from harness.ssp import common as ssc
from harness.ssp.binding import Element, verbatim, wrapped
from harness.ssp.parameters import Dictionary, ParameterMapping, ParameterSet

FMU_TYPE = "application/x-fmu-sharedlibrary"
SSD_TYPE = "application/x-ssp-definition"
SSP_TYPE = "application/x-ssp-package"
PARAMETER_SET_TYPE = "application/x-ssp-parameter-set"
MAPPING_TYPE = "application/x-ssp-parameter-mapping"
DICTIONARY_TYPE = "application/x-ssp-signal-dictionary"
CONNECTOR_KINDS = (
    "input", "output", "parameter", "calculatedParameter", "structuralParameter", "constant",
    "local", "inout", "unspecified",
)  # fmt: skip
SourceBase = Annotated[str, ("SSD", "component")]
Implementation = Annotated[str, ("any", "ModelExchange", "CoSimulation", "ScheduledExecution")]


class Connector(ssc.Entity, tags="ssd:Connector"):
    """A port of a system or component."""

    name: str
    kind: Annotated[str, CONNECTOR_KINDS]
    type: ssc.DataType | None = None
    dimensions: tuple[ssc.Dimension, ...] = ()
    geometry: tuple[str, ...] = verbatim("ssd:Clock", "ssd:ConnectorGeometry")


class MappingReference(ssc.Base, tags="ssd:ParameterMapping"):
    """A parameter mapping, inline or by `source`."""

    type: str = MAPPING_TYPE
    source: str | None = None
    source_base: SourceBase = "SSD"
    inline: ParameterMapping | None = None


class ParameterBinding(ssc.Entity, tags="ssd:ParameterBinding"):
    """A parameter set, inline or by `source`, given to an element."""

    type: str = PARAMETER_SET_TYPE
    source: str | None = None
    source_base: SourceBase = "SSD"
    prefix: str = ""
    inline: ParameterSet | None = wrapped("ParameterValues", default=None)
    mapping: MappingReference | None = None
    metadata: tuple[str, ...] = verbatim("ssc:MetaData", "ssc:Signature")


class ModelElement(ssc.Entity):
    """What systems, components and dictionary references have in common."""

    name: str
    connectors: tuple[Connector, ...] = wrapped("Connectors")
    geometry: tuple[str, ...] = verbatim("ssd:ElementGeometry")
    bindings: tuple[ParameterBinding, ...] = wrapped("ParameterBindings")
    metadata: tuple[str, ...] = verbatim("ssc:MetaData", "ssc:Signature")

    def connector(self, name: str) -> Connector | None:
        """The connector of that name, if it is declared."""
        return next((one for one in self.connectors if one.name == name), None)


class Component(ModelElement, tags="ssd:Component"):
    """An FMU, or another system description, named by `source`."""

    type: str = FMU_TYPE
    source: str | None = None
    implementation: Implementation = "any"


class DictionaryReference(ModelElement, tags="ssd:SignalDictionaryReference"):
    """Gives a system access to the signals of a dictionary of this or an enclosing system."""

    dictionary: str


class Connection(ssc.Entity, tags="ssd:Connection"):
    """A wire between connectors of a system (no element) and of its elements."""

    start_element: str | None = None
    start_connector: str
    start_indices: tuple[str, ...] = ()
    end_element: str | None = None
    end_connector: str
    end_indices: tuple[str, ...] = ()
    suppress_unit_conversion: bool = False
    transformation: ssc.Transformation | None = None
    geometry: tuple[str, ...] = verbatim("ssd:ConnectionGeometry")


class DictionaryDefinition(ssc.Base, tags="ssd:SignalDictionary"):
    """A signal dictionary, inline or by `source`."""

    name: str
    type: str = DICTIONARY_TYPE
    source: str | None = None
    source_base: SourceBase = "SSD"
    inline: Dictionary | None = None


Reference = ParameterBinding | MappingReference | DictionaryDefinition
"""A document of another kind, inline or by `source`."""


class SystemElement(ModelElement, tags="ssd:System"):
    """A system: elements, and the connections between their and its own connectors."""

    elements: tuple[Component | DictionaryReference | SystemElement, ...] = wrapped("Elements")
    connections: tuple[Connection, ...] = wrapped("Connections")
    dictionaries: tuple[DictionaryDefinition, ...] = wrapped("SignalDictionaries")
    graphics: tuple[str, ...] = verbatim("ssd:SystemGeometry", "ssd:GraphicalElements")


class DefaultExperiment(Element, tags="ssd:DefaultExperiment"):
    """Start and stop time (s), for information."""

    start_time: float | None = None
    stop_time: float | None = None
    annotations: tuple[ssc.Annotation, ...] = wrapped("Annotations")


class SystemStructure(ssc.TopLevel, tags="ssd:SystemStructureDescription"):
    """An SSD document."""

    name: str
    system: SystemElement
    enumerations: tuple[ssc.Enumeration, ...] = wrapped("Enumerations")
    units: tuple[ssc.UnitDefinition, ...] = wrapped("Units")
    experiment: DefaultExperiment | None = None
