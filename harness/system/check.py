"""Judges a system before anything is loaded; every fault names both ends and the legal choices.

All faults are reported at once, one sentence a line. What cannot be judged here (algebraic loops,
rates that share no cycle) is judged by the planner, still before anything is loaded.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import isfinite

from harness import registry
from harness.clock import show
from harness.errors import GraphError, HarnessError, UnitError, UsageError, nearest
from harness.fmi.description.model_description import (
    NUMERIC_TYPES,
    REAL_TYPES,
    ModelDescription,
    Variable,
)
from harness.fmi.start_values import judge_start_values
from harness.system.block import BlockSignal
from harness.system.graph import (
    ALGEBRAIC_LOOPS,
    Component,
    Connection,
    Descriptions,
    Endpoint,
    FmuComponent,
    PythonComponent,
    SensitivityComponent,
    System,
)
from harness.system.policy import DISCARDED_STEPS, SOLVERS, interface
from harness.system.units import Unit, conversion, parse_unit

TEXT_TYPES = ("String", "Binary")
ANY = "any"
"""The type of a port that takes what it is wired to."""
_READABLE = ("output", "local", "calculatedParameter", "independent")


@dataclass(frozen=True)
class PortInfo:
    """What stands at an end of a wire: unit (None where not stated), FMI type and start value."""

    unit: Unit | None
    type: str = "Float64"
    start: float = 0.0
    description: str = ""


def outputs_of(component: Component, descriptions: Descriptions) -> dict[str, PortInfo]:
    """The variables of a component that may be the source of a wire, by name."""
    if isinstance(component, FmuComponent):
        d = descriptions[component.name]
        return {v.name: port_info(v, d) for v in _ports(d) if v.causality in _READABLE}
    return _signals(component, component.outputs)


def inputs_of(component: Component, descriptions: Descriptions) -> dict[str, PortInfo]:
    """The variables of a component that may be the target of a wire, by name."""
    if isinstance(component, FmuComponent):
        d = descriptions[component.name]
        return {v.name: port_info(v, d) for v in _ports(d) if is_writable(v)}
    return _signals(component, component.inputs)


def ports_of(system: System, descriptions: Descriptions) -> Iterator[tuple[str, ...]]:
    """A row for each port of the interfaces of a system: name, direction, type, unit, what it is
    wired from, description. Parameters and local variables of FMUs are none."""
    sources = {c.target: str(c.source) for c in system.connections}
    for c in system.components:
        for direction, known in (
            ("input", inputs_of(c, descriptions)),
            ("output", outputs_of(c, descriptions)),
        ):
            for name, info in known.items():
                end = Endpoint(c.name, name)
                d = descriptions.get(c.name)
                if d is not None and d.port(name).causality != direction:
                    continue
                unit = "" if info.unit is None else info.unit.name
                yield str(end), direction, info.type, unit, sources.get(end, ""), info.description


def _signals(component: Component, signals: Iterable[BlockSignal]) -> dict[str, PortInfo]:
    """Ports of plain Python take what they are wired to, others are real."""
    kind = ANY if isinstance(component, PythonComponent) else "Float64"
    return {s.name: PortInfo(_stated(s.unit), kind, s.start, s.description) for s in signals}


def check(system: System, descriptions: Descriptions) -> None:
    """Raise `GraphError` with one line for each fault of `system`."""
    faults = list(_component_faults(system, descriptions))
    if not faults:
        faults = [f for c in system.connections for f in _wire_faults(system, c, descriptions)]
        faults += _wiring_faults(system)
    if faults:
        raise GraphError("\n".join(faults))


def _component_faults(system: System, descriptions: Descriptions) -> Iterator[str]:
    try:
        registry.check_name(registry.ALGORITHMS, system.algorithm, "algorithm")
    except UsageError as fault:
        yield str(fault)
    if system.algebraic_loops not in ALGEBRAIC_LOOPS:
        hint = nearest(system.algebraic_loops, ALGEBRAIC_LOOPS)
        yield f"algebraic_loops {system.algebraic_loops!r} is unknown; {hint}"
    convergence = system.convergence
    if not 0.0 < convergence.tolerance < 1.0:
        yield f"coupling tolerance {convergence.tolerance:g} must lie between 0 and 1"
    if convergence.max_iterations < 2:
        yield f"max_iterations {convergence.max_iterations} must be at least 2"
    if system.stop_ns <= system.start_ns and not system.single:
        yield f"stop time {show(system.stop_ns)} is not after start time {show(system.start_ns)}"
    for name, count in Counter(c.name for c in system.components).items():
        if count > 1:
            yield f"component name {name!r} is used {count} times; names must be unique"
    names = [c.name for c in system.components]
    run_ns = system.stop_ns - system.start_ns
    if 0 < run_ns < system.record_ns and not system.single:
        yield f"record step {show(system.record_ns)} is longer than the run of {show(run_ns)}"
    for component in system.components:
        if isinstance(component, FmuComponent):
            if 0 < run_ns < component.step_ns and not system.single:
                yield (
                    f"component {component.name}: step {show(component.step_ns)} is longer than "
                    f"the run of {show(run_ns)}"
                )
            yield from _fmu_faults(component, descriptions[component.name])
        elif isinstance(component, SensitivityComponent):
            yield from _sensitivity_faults(component, names, descriptions)


def _fmu_faults(component: FmuComponent, d: ModelDescription) -> Iterator[str]:
    try:
        interface(component.policy.interface_type, d)
    except HarnessError as fault:
        yield f"component {component.name}: {fault}"
    policy = component.policy
    for key, legal in (("solver", SOLVERS), ("discarded_steps", DISCARDED_STEPS)):
        if (word := getattr(policy, key)) not in legal:
            yield f"component {component.name}: {key} {word!r}: {nearest(word, legal)}"
    for key, value in (("tolerance", policy.tolerance), ("largest_step", policy.largest_step)):
        if value is not None and not (isfinite(value) and value > 0):
            yield f"component {component.name}: {key} must be positive, not {value!r}"
    given, validate = component.start_values, component.policy.validate
    try:
        judge_start_values(d, given, component=component.name, validate=validate)
    except UsageError as faults:
        yield str(faults)


def _sensitivity_faults(
    c: SensitivityComponent, names: list[str], descriptions: Descriptions
) -> Iterator[str]:
    if c.component not in descriptions:
        hint = nearest(c.component, descriptions or names)
        yield f"sensitivity {c.name}: no FMU component {c.component!r}; {hint}"
        return
    d = descriptions[c.component]
    for variable, causality in ((c.output, "output"), (c.input, "input")):
        legal = [v.name for v in d.variables.values() if v.causality == causality]
        if variable not in legal:
            hint = nearest(variable, legal)
            yield f"sensitivity {c.name}: {c.component} has no {causality} {variable!r}; {hint}"
    if d.co_simulation is None or not d.co_simulation.provides_directional_derivatives:
        yield f"sensitivity {c.name}: FMU {c.component} provides no directional derivatives"


def _wire_faults(
    system: System, connection: Connection, descriptions: Descriptions
) -> Iterator[str]:
    label = f"connection {connection.source} -> {connection.target}"
    infos = []
    for end, ports in ((connection.source, outputs_of), (connection.target, inputs_of)):
        try:
            component = system.component(end.component)
        except KeyError:
            hint = nearest(end.component, [c.name for c in system.components])
            yield f"{label}: no component {end.component!r}; {hint}"
            continue
        known = ports(component, descriptions)
        if end.variable not in known:
            what = "input" if ports is inputs_of else "output"
            hint = nearest(end.variable, known)
            yield f"{label}: {end.component} has no {what} {end.variable!r}; {hint}"
            continue
        infos.append(known[end.variable])
    on_wire = connection.delay_ns or connection.imperfections
    if on_wire and any(info.type in TEXT_TYPES for info in infos):
        yield f"{label}: texts can be neither delayed nor disturbed"
    if connection.delay_ns < 0:
        yield f"{label}: delay {show(connection.delay_ns)} is negative"
    if len(infos) == 2:
        yield from _type_faults(label, infos[0], infos[1], connection.convert_units)
        yield from _extrapolation_faults(label, system, connection, infos)
        if not (isfinite(connection.factor) and isfinite(connection.offset)):
            numbers = f"factor {connection.factor} and offset {connection.offset}"
            yield f"{label}: {numbers} must be finite"


def _type_faults(
    label: str, source: PortInfo, target: PortInfo, convert_units: bool
) -> Iterator[str]:
    if "[" in source.type + target.type:
        yield (
            f"{label}: {source.type} to {target.type}: arrays are wired whole where their "
            "dimensions are equal, or by element, as in a[1]"
        )
        return
    families = {_family(info.type) for info in (source, target)} - {ANY}
    if len(families) > 1:
        yield (
            f"{label}: {source.type} cannot be wired to {target.type}; numbers, booleans and "
            "clocks can among themselves, strings to strings, binaries to binaries"
        )
        return
    if not convert_units:
        return
    try:
        conversion(source.unit, target.unit)
    except UnitError as fault:
        yield f"{label}: {fault}; convert_units = false on it passes the number as it is"


def _family(kind: str) -> str:
    """Types that can be wired to each other."""
    return kind if kind in (*TEXT_TYPES, ANY) else "number"


def _extrapolation_faults(
    label: str, system: System, connection: Connection, infos: list[PortInfo]
) -> Iterator[str]:
    if connection.extrapolation not in (0, 1):
        order = connection.extrapolation
        yield f"{label}: extrapolation {order!r} is neither 0 (hold) nor 1 (linear)"
    if connection.extrapolation != 1:
        return
    ends = (connection.source, connection.target)
    if not all(isinstance(system.component(end.component), FmuComponent) for end in ends):
        yield f"{label}: only a wire from FMU to FMU can be extrapolated; what blocks write is held"
    elif connection.delay_ns or connection.imperfections:
        yield f"{label}: a wire with a delay or with imperfections cannot be extrapolated"
    elif not all(info.type in REAL_TYPES for info in infos):
        kinds = " to ".join(info.type for info in infos)
        yield f"{label}: only real numbers can be extrapolated, not {kinds}"


def _wiring_faults(system: System) -> Iterator[str]:
    targets: dict[Endpoint, list[Connection]] = {}
    for connection in system.connections:
        targets.setdefault(connection.target, []).append(connection)
    for target, connections in targets.items():
        if len(connections) > 1:
            sources = " and ".join(str(c.source) for c in connections)
            yield f"input {target} is connected {len(connections)} times: from {sources}"
    for component in system.components:
        if isinstance(component, FmuComponent):
            continue
        for signal in component.inputs:
            end = Endpoint(component.name, signal.name)
            if end not in targets and not getattr(signal, "optional", False):
                yield (
                    f"input {end} is not connected; connect a signal to it, for instance a constant"
                )


def _ports(d: ModelDescription) -> Iterator[Variable]:
    """Variables, and the elements of arrays."""
    yield from d.variables.values()
    yield from map(d.port, d.elements)


def is_writable(v: Variable) -> bool:
    """Whether a variable may get new values during a run: an input or a tunable parameter."""
    return v.causality == "input" or (v.causality == "parameter" and v.variability == "tunable")


def port_info(v: Variable, d: ModelDescription) -> PortInfo:
    """What a variable of an FMU is as a port."""
    start = 0.0
    if v.type in NUMERIC_TYPES and v.start is not None and not v.shape:
        text = str(v.start).lower()
        start = float(text in ("true", "1")) if v.type == "Boolean" else float(text)
    kind = f"{v.type}[{','.join(map(str, v.shape))}]" if v.shape else v.type
    return PortInfo(_stated(v.unit, d.units), kind, start, v.description)


def _stated(name: str | None, units: Mapping[str, Unit] | None = None) -> Unit | None:
    return parse_unit(name, units) if name else None
