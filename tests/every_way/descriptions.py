"""modelDescription.xml of FMI 1, 2 and 3 from one list of variables, in the words of FMI 3.

Where FMI 3 has an `<Alias>`, FMI 1 and 2 have a variable of its own with the same value reference;
only FMI 1 has negated ones. Types that a version lacks leave the variable out.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from xml.etree import ElementTree as ET

OLD_TYPES = {
    "Float64": "Real", "Int32": "Integer", "Boolean": "Boolean", "String": "String",
    "Enumeration": "Enumeration",
}  # fmt: skip
KINDS = {
    "co-simulation": "CoSimulation",
    "model-exchange": "ModelExchange",
    "scheduled-execution": "ScheduledExecution",
}
ITEMS = {"low": "1", "high": "7"}


@dataclass(frozen=True)
class Alias:
    name: str
    negated: bool = False
    causality: str = "output"
    derivative_of: str | None = None


@dataclass(frozen=True)
class Variable:
    """`dimensions` are sizes, or ("n",) names of structural parameters."""

    name: str
    reference: int
    type: str = "Float64"
    causality: str = "output"
    start: str | None = None
    derivative_of: str | None = None
    aliases: tuple[Alias, ...] = ()
    dimensions: tuple[int | str, ...] = ()
    more: dict[str, str] = field(default_factory=dict)

    @property
    def variability(self) -> str:
        if self.causality in ("parameter", "structuralParameter"):
            return "fixed"
        return "continuous" if self.type in ("Float64", "Float32") else "discrete"


@dataclass(frozen=True)
class Model:
    """`indicators` are names; `event_mode`: FMI 3 co-simulation has one, and returns early."""

    name: str
    variables: tuple[Variable, ...]
    kinds: tuple[str, ...] = ("co-simulation", "model-exchange")
    indicators: tuple[str, ...] = ()
    event_mode: bool = False
    step: float = 2.0**-6
    stop: float = 2.0
    tolerance: float = 1e-10

    @property
    def states(self) -> list[str]:
        return [v.derivative_of for v in self.variables if v.derivative_of]


def fmi1(model: Model, kind: str) -> str:
    root = _root(model, "1.0", "guid", modelIdentifier=model.name, **_counts(model))
    _enumeration(ET.SubElement(root, "TypeDefinitions"), "Type", "EnumerationType")
    _experiment(model, root)
    found = ET.SubElement(root, "ModelVariables")
    for v, alias in _scalars(model):
        v = replace(v, start=v.start or ("0" if v.causality == "input" else None))
        role = {"local": "internal", "parameter": "internal"}.get(v.causality, v.causality)
        variability = "parameter" if v.causality == "parameter" else v.variability
        more = {"alias": "negatedAlias" if alias.negated else "alias"} if alias else {}
        one = _scalar(found, v, causality=role, variability=variability, **more)
        one.attrib.pop("derivative", None)
    if kind == "co-simulation":
        slave = ET.SubElement(ET.SubElement(root, "Implementation"), "CoSimulation_StandAlone")
        ET.SubElement(slave, "Capabilities", canHandleVariableCommunicationStepSize="true",
                      canHandleEvents="true")  # fmt: skip
    return ET.tostring(root, "unicode")


def fmi2(model: Model) -> str:
    root = _root(model, "2.0", "guid", numberOfEventIndicators=str(len(model.indicators)))
    for kind in model.kinds[::-1]:  # in the order of the schema
        more = {"canHandleVariableCommunicationStepSize": "true"} if kind[0] == "c" else {}
        ET.SubElement(root, KINDS[kind], modelIdentifier=model.name,
                      canGetAndSetFMUstate="true", **more)  # fmt: skip
    _enumeration(ET.SubElement(root, "TypeDefinitions"), "SimpleType", "Enumeration")
    _experiment(model, root)
    found = ET.SubElement(root, "ModelVariables")
    rows = [v for v, alias in _scalars(model) if not (alias and alias.negated)]
    index = {v.name: str(i) for i, v in enumerate(rows, start=1)}
    structure = ET.SubElement(root, "ModelStructure")
    derived = [v for v in rows if v.derivative_of]
    for v in rows:
        initial = {"initial": "exact"} if v.start and v.causality in ("output", "local") else {}
        one = _scalar(found, v, causality=v.causality, variability=v.variability, **initial)
        if v.derivative_of:
            one.set("derivative", index[v.derivative_of])
    outputs = [v for v in rows if v.causality == "output"]
    calculated = [v for v in rows if v in derived + outputs and v.start is None]
    for title, some in (
        ("Outputs", outputs), ("Derivatives", derived), ("InitialUnknowns", calculated)
    ):  # fmt: skip
        if some:
            group = ET.SubElement(structure, title)
            for v in some:
                ET.SubElement(group, "Unknown", index=index[v.name])
    return ET.tostring(root, "unicode")


def fmi3(model: Model) -> str:
    root = _root(model, "3.0", "instantiationToken")
    for kind in sorted(model.kinds, key=lambda kind: kind[0] != "m"):
        can = {"canGetAndSetFMUState": "true"} if kind[0] != "s" else {}
        if kind == "co-simulation":
            early = str(model.event_mode).lower()
            can |= {"canHandleVariableCommunicationStepSize": "true", "hasEventMode": early,
                    "mightReturnEarlyFromDoStep": early}  # fmt: skip
        elif kind == "model-exchange":
            can["needsCompletedIntegratorStep"] = "true"
        ET.SubElement(root, KINDS[kind], modelIdentifier=model.name, **can)
    _enumeration(ET.SubElement(root, "TypeDefinitions"), "EnumerationType", None)
    _experiment(model, root)
    found = ET.SubElement(root, "ModelVariables")
    ET.SubElement(found, "Float64", name="time", valueReference="99", causality="independent")
    by_name = {v.name: str(v.reference) for v in model.variables}
    for v in model.variables:
        one = ET.SubElement(found, v.type, name=v.name, valueReference=str(v.reference),
                            causality=v.causality, **v.more)  # fmt: skip
        if v.type != "Clock":
            one.set("variability", v.variability)
        if v.type == "Enumeration":
            one.set("declaredType", "Option")
        if v.derivative_of:
            one.set("derivative", by_name[v.derivative_of])
        for size in v.dimensions:
            key = "start" if isinstance(size, int) else "valueReference"
            ET.SubElement(one, "Dimension", {key: by_name.get(str(size), str(size))})
        if v.start is not None and v.type in ("String", "Binary"):
            ET.SubElement(one, "Start", value=v.start)
        elif v.start is not None:
            one.set("start", v.start)
        if v.start is not None and v.causality in ("output", "local"):
            one.set("initial", "exact")
        for alias in v.aliases:
            if not alias.negated and not alias.derivative_of:
                ET.SubElement(one, "Alias", name=alias.name)
    structure = ET.SubElement(root, "ModelStructure")
    outputs = [v for v in model.variables if v.causality == "output"]
    derived = [v for v in model.variables if v.derivative_of]
    calculated = [
        v for v in model.variables
        if v in outputs + derived and v.start is None and "clocks" not in v.more
        and v.type != "Clock"
    ]  # fmt: skip
    for title, some in (
        ("Output", outputs), ("ContinuousStateDerivative", derived),
        ("InitialUnknown", calculated),
        ("EventIndicator", [v for v in model.variables if v.name in model.indicators]),
    ):  # fmt: skip
        for v in some:
            ET.SubElement(structure, title, valueReference=str(v.reference))
    return ET.tostring(root, "unicode")


def _root(model: Model, version: str, token: str, **more: str) -> ET.Element:
    more |= {token: f"{{{model.name}}}", "modelName": model.name}
    return ET.Element("fmiModelDescription", fmiVersion=version, **more)


def _counts(model: Model) -> dict[str, str]:
    return {
        "numberOfContinuousStates": str(len(model.states)),
        "numberOfEventIndicators": str(len(model.indicators)),
    }


def _experiment(model: Model, root: ET.Element) -> None:
    step = {} if root.get("fmiVersion") == "1.0" else {"stepSize": repr(model.step)}
    ET.SubElement(root, "DefaultExperiment", startTime="0", stopTime=repr(model.stop),
                  tolerance=repr(model.tolerance), **step)  # fmt: skip


def _enumeration(types: ET.Element, tag: str, inner: str | None) -> None:
    made = ET.SubElement(types, tag, name="Option")
    place = made if inner is None else ET.SubElement(made, inner)
    for name, value in ITEMS.items():
        ET.SubElement(place, "Item", {"name": name} | ({"value": value} if tag != "Type" else {}))


def _scalars(model: Model) -> Iterator[tuple[Variable, Alias | None]]:
    """Each variable that FMI 1 and 2 can have, then its aliases as variables of their own; where
    an alias is the derivative, the variable itself is none."""
    for v in model.variables:
        if v.type not in OLD_TYPES or v.dimensions or v.causality == "structuralParameter":
            continue
        derived = any(alias.derivative_of for alias in v.aliases)
        yield replace(v, derivative_of=None if derived else v.derivative_of, aliases=()), None
        for a in v.aliases:
            one = replace(v, name=a.name, causality=a.causality, start=None, aliases=())
            yield replace(one, derivative_of=a.derivative_of), a


def _scalar(place: ET.Element, v: Variable, **attributes: str) -> ET.Element:
    scalar = ET.SubElement(place, "ScalarVariable", name=v.name,
                           valueReference=str(v.reference), **attributes)  # fmt: skip
    value = ET.SubElement(scalar, OLD_TYPES[v.type])
    if v.start is not None:
        value.set("start", v.start)
    if v.type == "Enumeration":
        value.set("declaredType", "Option")
    return value
