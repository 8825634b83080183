"""What a run records: the ports that match the user's patterns, and the columns they become."""

from __future__ import annotations

from collections.abc import Mapping
from fnmatch import fnmatchcase

from harness.errors import GraphError, nearest
from harness.fmi.description.model_description import ModelDescription
from harness.fmi.fmu import Fmu
from harness.master.opened import descriptions_of
from harness.master.plan.planner import Plan
from harness.master.program.layout import cells_of
from harness.results.columns import Column, bare_name
from harness.system.check import inputs_of, outputs_of
from harness.system.graph import Endpoint, FmuComponent, System

_TYPES = {
    "Real": "real", "Float64": "real", "Float32": "float32", "Boolean": "boolean",
    "Clock": "clock", "Int64": "int64", "UInt64": "uint64", "String": "text", "Binary": "binary",
}  # fmt: skip


def recorded_ports(
    system: System, descriptions: Mapping[str, ModelDescription], patterns: tuple[str, ...]
) -> tuple[Endpoint, ...]:
    """FMU outputs and connected inputs, block inputs and outputs that match a pattern.

    A pattern with no wildcard may also name any local variable of an FMU, or an array, which is
    recorded element by element. Raises `GraphError`
    where a pattern matches nothing.
    """
    wired = {c.target for c in system.connections}
    offered: list[Endpoint] = []
    exact: list[Endpoint] = []
    for c in system.components:
        readable = [Endpoint(c.name, name) for name in outputs_of(c, descriptions)]
        inputs = [Endpoint(c.name, name) for name in inputs_of(c, descriptions)]
        if isinstance(c, FmuComponent):
            d = descriptions[c.name]
            ports = map(d.port, [*d.variables, *d.elements])
            kinds = {v.name for v in ports if not v.shape}
            exact += [end for end in readable if end.variable in kinds]
            causal = {name for v in d.outputs for name in d.whole(v.name)}
            readable = [e for e in readable if e.variable in causal and e.variable in kinds]
            inputs = [end for end in inputs if end in wired]
        offered += [*readable, *inputs]
    chosen: dict[Endpoint, None] = {}
    for pattern in patterns:
        every = [*offered, *exact]
        found = [end for end in every if pattern in (str(end), str(end).partition("[")[0])]
        found = found or [end for end in offered if fnmatchcase(str(end), pattern)]
        if not found:
            hint = nearest(pattern, [str(end) for end in [*offered, *exact]])
            raise GraphError(f"nothing to record matches {pattern!r}; {hint}")
        chosen.update(dict.fromkeys(found))
    return tuple(chosen)


def columns_of(plan: Plan, fmus: Mapping[str, Fmu]) -> tuple[Column, ...]:
    """What the columns of a recorded row are; an input without a unit has that of its source."""
    descriptions = descriptions_of(plan.lowered.system, fmus)
    system = plan.lowered.system
    sources = {c.target: c.source for c in system.connections}
    ports = {
        Endpoint(c.name, name): info
        for c in system.components
        for known in (inputs_of(c, descriptions), outputs_of(c, descriptions))
        for name, info in known.items()
    }

    cells = cells_of(plan.lowered, descriptions)

    def unit_of(end: Endpoint, hops: int = 8) -> str:
        unit = ports[end].unit
        if unit is None and end in sources and hops:
            return unit_of(sources[end], hops - 1)
        return unit.name if unit is not None else ""

    def type_of(end: Endpoint) -> str:
        d = descriptions.get(end.component)
        return cells.get(end, "real") if d is None else column_type(d, end.variable)

    def name_of(end: Endpoint) -> str:
        return bare_name(end.component, end.variable) if system.single else str(end)

    return tuple(
        Column(name_of(end), unit_of(end), ports[end].description, type_of(end))
        for end in plan.recorded
    )


def column_type(d: ModelDescription, name: str) -> str:
    """The type of the column of a variable or an element."""
    kind = d.port(name).type
    if kind == "Enumeration" and d.fmi_major == 3:
        return "int64"
    return _TYPES.get(kind, "integer")
