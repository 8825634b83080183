"""Our experiments as packages that other tools run: FMUs, wires, units, start values, times.

Every variant is a root description. Controllers and signals stand in it as FMUs; what SSP has no
words for stands in annotations of ours (`harness.ssp.settings`), by which the harness restores the
experiment exactly. Said aloud is what other tools do not see: delays and imperfections of wires,
and the step by which the output of a controller's FMU comes later than in our loop.

Refused, with the way out, are sensitivities and plain Python: there is nothing to make an FMU of.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from warnings import warn

from harness.clock import show, to_seconds
from harness.errors import ExperimentError, HarnessError
from harness.experiment.experiment import Experiment
from harness.export.controller import controller_fmu
from harness.ssp import DEFAULT
from harness.ssp import document as ssd
from harness.ssp.common import LinearTransformation
from harness.ssp.describe import Describer, unit_change
from harness.ssp.package import save_package
from harness.ssp.sequence import sequence_block
from harness.ssp.settings import OSP_NAMESPACE, annotation, osp_step, safe_name, unique
from harness.ssp.to_experiment import FMU_SETTINGS, REPORT, WIRE_SETTINGS, describe_fmu, sha256
from harness.system import graph

Table = dict[str, Any]

_STRUCTURE = {"components", "connections", "variants", "extends", "stop_time", "start_time"}


@dataclass
class Resources:
    """The files of a package by member name; files of the same content are one."""

    files: dict[str, Path] = field(default_factory=dict)
    members: dict[tuple[str, str], str] = field(default_factory=dict)

    def add(self, name: str, path: Path) -> str:
        """The member name under which a file stands: `resources/name`, or with a number."""
        plain, suffix = f"resources/{Path(name).stem}", Path(name).suffix
        content = sha256(path), suffix
        if content not in self.members:
            self.members[content] = unique(plain, self.files, suffix)
            self.files[self.members[content]] = path
        return self.members[content]


def export_experiment(experiment: Experiment, target: Path, variants: Sequence[str]) -> None:
    """Write variants of an experiment as a package, the first as its default.

    Raises `ExperimentError` with one line for each variant that cannot be exported.
    """
    resources, faults = Resources(), []
    structures: dict[str, ssd.SystemStructure] = {}
    for variant in variants:
        file = f"{safe_name(variant)}.ssd" if structures else DEFAULT
        try:
            exporter = _Exporter(experiment, variant, tuple(variants), resources)
            structures[file] = exporter.structure(first=not structures)
        except HarnessError as fault:
            faults.append(f"{experiment.name} ({variant}) cannot be exported: {fault}")
    if faults:
        raise ExperimentError("\n".join(faults))
    save_package(target, structures, resources.files)


@dataclass
class _Exporter:
    """A variant on its way into a package; the FMUs of its blocks are there afterwards."""

    experiment: Experiment
    variant: str
    variants: tuple[str, ...]
    resources: Resources

    def __post_init__(self) -> None:
        self.spec = self.experiment.variant_spec(self.variant)
        self.system = self.experiment.bench(self.variant).system()
        self.sources = {c.name: self._source(c) for c in self.system.components}
        self.descriptions = {name: describe_fmu(path) for name, path in self.sources.items()}
        newest = max(d.fmi_major for d in self.descriptions.values())
        self.describer = Describer("2.0" if newest > 2 else "1.0")

    def structure(self, *, first: bool) -> ssd.SystemStructure:
        spec, components = self.spec, self.system.components
        root = ssd.SystemElement(
            name=self.variant,
            description=spec.title,
            elements=tuple(map(self._component, components)),
            connections=tuple(map(self._connection, self.system.connections)),
        )
        step = min(
            c.step_ns if isinstance(c, graph.FmuComponent) else c.period_ns for c in components
        )
        return ssd.SystemStructure(
            namespaces=(OSP_NAMESPACE,),
            version=self.describer.version,
            name=self.variant,
            generation_tool="fmu-harness",
            system=root,
            units=self.describer.units(),
            experiment=ssd.DefaultExperiment(
                start_time=spec.start_time,
                stop_time=spec.stop_time,
                annotations=(osp_step(to_seconds(step)),),
            ),
            annotations=annotation(self._settings(report=first)),
        )

    def _settings(self, *, report: bool) -> Table:
        spec = self.spec
        given = spec.model_dump(by_alias=True, exclude_unset=True, exclude=_STRUCTURE)
        variant = self.experiment.spec.variants.get(self.variant)
        if variant is not None and variant.label is not None:
            given["label"] = variant.label
        if report:
            base = self.experiment.spec.model_dump(
                by_alias=True, exclude_unset=True, include=set(REPORT)
            )
            given["report"] = {k: v for k, v in base.items() if given.get(k) != v}
            _only(given["report"], self.variants)
            if len(self.variants) > 1:
                given["order"] = list(self.variants)
        _only(given, self.variants)
        return {"step": spec.step, "algorithm": spec.algorithm, **given}

    def _source(self, c: graph.Component) -> Path:
        """The FMU of a component."""
        if isinstance(c, graph.FmuComponent):
            return c.path
        if isinstance(c, graph.SensitivityComponent):
            raise ExperimentError(
                f"component {c.name} is a sensitivity, which the harness computes and no FMU can; "
                "choose variants without one by --variant"
            )
        if isinstance(c, graph.PythonComponent):
            raise ExperimentError(
                f"component {c.name} is plain Python, of which no FMU can be made; write it as a "
                "block with step(p, x, u, y), as the README of the controllers shows"
            )
        return controller_fmu(
            sequence_block(c, self.system) if isinstance(c, graph.SignalComponent) else c.block,
            c.name,
            to_seconds(c.period_ns),
            self.spec.fmi_version,
            phase=to_seconds(c.phase_ns),
            portable=self.spec.portable,
        )

    def _component(self, c: graph.Component) -> ssd.Component:
        source, description = self.sources[c.name], self.descriptions[c.name]
        ends = [end for wire in self.system.connections for end in (wire.source, wire.target)]
        used = {end.variable for end in ends if end.component == c.name}
        given = self.spec.components[c.name].model_dump(by_alias=True, exclude_unset=True)
        bindings: tuple[ssd.ParameterBinding, ...] = ()
        if isinstance(c, graph.FmuComponent):
            bindings = self.describer.start_value_binding(c.name, c.start_values, description)
            own = {k: v for k, v in given.items() if k in FMU_SETTINGS and v is not None}
        else:
            own = {**given, "fmu_sha256": sha256(source)}
            parameters = given.get("parameters", {})
            if "signal" in given and "file" in parameters:
                file = self.experiment.path.parent / parameters["file"]
                member = self.resources.add(f"{safe_name(c.name)}{file.suffix}", file)
                own["parameters"] = {**parameters, "file": member}
            if isinstance(c, graph.BlockComponent):
                self._say(f"{c.name} is an FMU there: what it computes arrives one communication "
                          f"step ({show(c.period_ns)}) later than in this loop")  # fmt: skip
        return ssd.Component(
            name=c.name,
            source=self.resources.add(f"{safe_name(c.name)}.fmu", source),
            implementation="CoSimulation",
            connectors=self.describer.connectors(description, used),
            bindings=bindings,
            annotations=annotation(own),
        )

    def _connection(self, wire: graph.Connection) -> ssd.Connection:
        given = self.spec.connections[str(wire.target)].model_dump(exclude_defaults=True)
        own = {k: v for k, v in given.items() if k in WIRE_SETTINGS}
        if own:
            self._say(f"the {' and '.join(own)} on {wire.source} -> {wire.target} are in an "
                      "annotation of ours only")  # fmt: skip
        ends = (wire.source, wire.target)
        if wire.convert_units and (change := unit_change(*ends, self.descriptions)):
            self._say(
                f"the conversion of {change} on {wire.source} -> {wire.target} is left to the "
                "tool; for one that does none, state a factor and convert_units = false"
            )
        linear = LinearTransformation(factor=wire.factor, offset=wire.offset)
        return ssd.Connection(
            start_element=wire.source.component,
            start_connector=wire.source.variable,
            end_element=wire.target.component,
            end_connector=wire.target.variable,
            suppress_unit_conversion=not wire.convert_units,
            transformation=None if linear == LinearTransformation() else linear,
            annotations=annotation(own),
        )

    def _say(self, what: str) -> None:
        warn(f"in other tools {what}", stacklevel=2)


def _only(settings: Table, variants: tuple[str, ...]) -> None:
    """Leave out what is about variants that are not exported: their plots, and a study whose
    baseline is one of them."""
    measure = settings.get("measure", {})
    if "variants" in measure:
        measure["variants"] = tuple(one for one in measure["variants"] if one in variants)
    plots = settings.get("plots", {})
    for name, plot in list(plots.items()):
        if plot.get("variants"):
            plot["variants"] = tuple(one for one in plot["variants"] if one in variants)
            if not plot["variants"]:
                del plots[name]
    if settings.get("study") and settings["study"]["baseline"] not in variants:
        del settings["study"]
