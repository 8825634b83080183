"""A package as an experiment: every root description is a variant.

The structure, the wires and the start values are what the descriptions say; our annotations add
what SSP has no words for. A component that stands for one of our controllers or signals runs in
process, as it was before the export, unless its FMU or its parameters were changed since: then the
FMU runs. Refused are arrays of connectors and types that no wire carries.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import dataclass, fields
from functools import cache, partial
from pathlib import Path
from typing import Any
from warnings import warn

from harness.errors import ExperimentError, UnitError, at
from harness.experiment.experiment import Experiment
from harness.experiment.merging import merge
from harness.experiment.schema import (
    ConnectionSpec,
    ControllerSpec,
    ExperimentSpec,
    SignalSpec,
)
from harness.fmi.binding.interface import MODEL_EXCHANGE, SCHEDULED_EXECUTION
from harness.fmi.description.model_description import ModelDescription
from harness.fmi.fmu import Fmu
from harness.ssp.change import as_float
from harness.ssp.common import LinearTransformation
from harness.ssp.defaults import own_steps, times
from harness.ssp.flatten import FlatWire, change_along, flat_wires
from harness.ssp.package import Package, left_out_where_faulty, open_package, read_bytes
from harness.ssp.ports import Ports
from harness.ssp.settings import check_names, safe_name, settings_of, unique
from harness.ssp.start_values import start_values
from harness.ssp.tree import FmuNode, Tree, TreePath, build_tree
from harness.system.policy import Policy
from harness.system.units import conversion

Table = dict[str, Any]

REPORT = ("title", "description", "measure", "plots", "metrics", "study", "sweep")
"""What an experiment says for all of its variants."""

TOP_SETTINGS = (
    *(f for f in ExperimentSpec.model_fields
      if f not in ("components", "connections", "variants", "extends", "stop_time", "start_time")),
    "label", "report", "order",
)  # fmt: skip
FMU_SETTINGS = ("step", *(f.name for f in fields(Policy)))
WIRE_SETTINGS = tuple(
    f for f in ConnectionSpec.model_fields
    if f not in ("source", "factor", "offset", "convert_units")
)  # fmt: skip
"""What SSP has no words for, of FMUs and of connections."""

_COMPONENT = (
    *dict.fromkeys((*FMU_SETTINGS, *ControllerSpec.model_fields, *SignalSpec.model_fields)),
    "fmu_sha256",
)


@contextmanager
def open_experiment(
    path: str | Path, settings: Mapping[str, Any] | None = None, *, in_process: bool = True
) -> Iterator[Experiment]:
    """The experiment that a package is, while its files are there; raises `ExperimentError`.

    `settings` are merged into every variant. With `in_process` off, the FMUs of controllers and
    signals run, as they do in other tools.
    """
    with open_package(path) as package, ExitStack() as stack:
        validate = (settings or {}).get("validate_fmus", True)
        describe = cache(partial(describe_fmu, validate=validate))
        names = variant_names(package)
        variants: dict[str, Table] = {}
        for file in _ordered(package, names):
            others = file != next(iter(names))
            with left_out_where_faulty(package.where(file)) if others else nullcontext():
                tree = build_tree(package, file, stack)
                table = _Importer(package, file, Ports(tree, describe), in_process).table()
                variants[names[file]] = merge(table, settings or {})
        report = next(iter(variants.values())).get("report", {})
        for table in variants.values():
            table.pop("order", None)
            table.pop("report", None)
        base = {k: v for k, v in next(iter(variants.values())).items() if k != "label"} | report
        complete = {name: {**table, "standalone": True} for name, table in variants.items()}
        data = merge(base, settings or {}) | {"variants": complete}
        yield Experiment.from_data(data, package.path)


def describe_fmu(path: Path, validate: bool = True) -> ModelDescription:
    """The description of an FMU; raises `FmuError`."""
    with Fmu(path, validate=validate) as fmu:
        return fmu.description


def variant_names(package: Package) -> dict[str, str]:
    """The name of the variant that each root description is: its own name, or that of its file
    where another has it already."""
    names = [one.name for one in package.structures.values()]
    found: dict[str, str] = {}
    for file, structure in package.structures.items():
        single = names.count(structure.name) == 1
        name = safe_name(structure.name if single else Path(file).stem)
        found[file] = unique(name, found.values())
    return found


def _ordered(package: Package, names: Mapping[str, str]) -> list[str]:
    """The root descriptions in the order of variants that the default one states, if it does."""
    default = next(iter(names))
    given = package.structures[default].annotations
    order = settings_of(given, TOP_SETTINGS, package.where(default)).get("order", ())
    rank = {name: i for i, name in enumerate(order)} if isinstance(order, list) else {}
    return sorted(names, key=lambda file: (rank.get(names[file], len(rank)), file != default))


@dataclass(frozen=True)
class _Importer:
    package: Package
    file: str
    ports: Ports
    in_process: bool

    @property
    def where(self) -> str:
        return self.package.where(self.file)

    def table(self) -> Table:
        """The description as the content of an experiment file."""
        structure = self.package.structures[self.file]
        top = settings_of(structure.annotations, TOP_SETTINGS, self.where)
        check_names(top, self.where)
        check_names(top.get("report", {}), self.where)
        wires = flat_wires(self.ports)
        starts = start_values(self.ports, wires)
        names = flat_names(self.ports.tree)
        components = {
            names[node.path]: self._component(node, starts.get(node.path, {}))
            for node in self.ports.tree.fmus
        }
        if not components:
            raise ExperimentError(f"{self.where} has no FMU to run; add a component with one")
        fmus = {
            names[node.path]: self.ports.describe(node.source)
            for node in self.ports.tree.fmus
            if "fmu" in components[names[node.path]]
        }
        title = {"title": structure.system.description or structure.description or structure.name}
        found = {**title, **times(structure, top, fmus, self.where), **top}
        if "step" not in top:
            for name, step in own_steps(found["step"], fmus, self.where).items():
                components[name].setdefault("step", step)
        connections = {
            f"{names[wire.target.path]}.{wire.target.name}": self._wire(wire, names)
            for wire in wires
            if wire.driven
        }
        return {**found, "components": components, "connections": connections}

    def _component(self, node: FmuNode, starts: Table) -> Table:
        place = f"{self.where}: component {'.'.join(node.path)}"
        own = settings_of(node.element.annotations, _COMPONENT, place)
        digest = own.pop("fmu_sha256", None)
        stands_for = next((k for k in ("controller", "signal") if k in own), None)
        if stands_for is not None and self.in_process:
            changed = digest is not None and digest != sha256(node.source)
            if not changed and not starts:
                parameters = own.get("parameters")
                if stands_for == "signal" and isinstance(parameters, dict) and "file" in parameters:
                    with at(place):
                        file = self.package.resolve(str(parameters["file"]))
                    own["parameters"] = {**parameters, "file": str(file)}
                return own
            what = "its FMU was exchanged" if changed else "it has parameters of its own"
            warn(f"{place} runs as an FMU, not in process: {what}", stacklevel=2)
        made: Table = {"fmu": str(node.source), **{k: own[k] for k in FMU_SETTINGS if k in own}}
        if demanded := _INTERFACES.get(node.element.implementation):
            made.setdefault("interface_type", demanded)
        if stands_for is not None and "sample_time" in own:
            made["step"] = own["sample_time"]
        return made | ({"start_values": starts} if starts else {})

    def _wire(self, wire: FlatWire, names: Mapping[TreePath, str]) -> Table:
        made: Table = {"from": f"{names[wire.source.path]}.{wire.source.name}"}
        own: Table = {}
        for edge in wire.edges:
            given = settings_of(edge.connection.annotations, WIRE_SETTINGS, edge.place)
            if given and own:
                raise ExperimentError(
                    f"{edge.place}: delays or imperfections in two places of one way from output "
                    "to input; leave one of the annotations out"
                )
            own |= given
        only = wire.edges[0].connection
        linear = only.transformation or LinearTransformation()
        plain = len(wire.edges) == 1 and isinstance(linear, LinearTransformation)
        if plain and self._as_the_harness_converts(wire):
            assert isinstance(linear, LinearTransformation)
            made |= {"factor": linear.factor, "offset": linear.offset}
            return made | {"convert_units": not only.suppress_unit_conversion} | own
        source = self.ports.port(wire.source)
        change = change_along(wire.edges, self.ports, source.unit)
        if change.table:
            table = {"kind": "value_map", "table": [list(pair) for pair in change.table]}
            own["imperfections"] = [table, *own.get("imperfections", ())]
        made |= {"factor": as_float(change.factor), "offset": as_float(change.offset)}
        return made | {"convert_units": False} | own

    def _as_the_harness_converts(self, wire: FlatWire) -> bool:
        """Whether the variables' units, which the harness knows, say what the connectors say."""
        edge = wire.edges[0]
        said = [self.ports.port(end).unit for end in (wire.source, wire.target)]
        known = [self.ports.variable_unit(end) for end in (wire.source, wire.target)]
        if edge.connection.suppress_unit_conversion:
            return True
        try:
            return conversion(said[0], said[1]) == conversion(known[0], known[1])
        except UnitError:
            return False


_INTERFACES = {"ModelExchange": MODEL_EXCHANGE, "ScheduledExecution": SCHEDULED_EXECUTION}
"""What is not co-simulation, which is taken where an FMU offers it."""


def flat_names(tree: Tree) -> dict[TreePath, str]:
    """A component name for each FMU: its path joined by "_", each name once."""
    found: dict[TreePath, str] = {}
    for node in tree.fmus:
        name = "_".join(part.replace(".", "_").replace("/", "_") for part in node.path)
        found[node.path] = unique(name, found.values())
    return found


def sha256(path: Path) -> str:
    """The hash of a file, in hexadecimal; raises `ExperimentError`."""
    return hashlib.sha256(read_bytes(path, str(path))).hexdigest()
