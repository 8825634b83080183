"""What a run records: the ports that match the user's patterns, and the columns they become."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase

from harness.errors import GraphError, UsageError, nearest
from harness.fmi.description.model_description import ModelDescription, Variable
from harness.fmi.fmu import Fmu
from harness.master.opened import descriptions_of
from harness.master.plan.planner import Plan
from harness.master.program.layout import cells_of
from harness.results.columns import Column, bare_name
from harness.system.check import inputs_of, outputs_of, port_info
from harness.system.graph import Endpoint, FmuComponent, System

_TYPES = {
    "Real": "real", "Float64": "real", "Float32": "float32", "Boolean": "boolean",
    "Clock": "clock", "Int64": "int64", "UInt64": "uint64", "String": "text", "Binary": "binary",
}  # fmt: skip


def recorded_ports(
    system: System,
    descriptions: Mapping[str, ModelDescription],
    patterns: tuple[str | Endpoint, ...],
) -> tuple[Endpoint, ...]:
    """FMU outputs and connected inputs, block inputs and outputs that match a pattern.

    A pattern with no wildcard may also name any local variable of an FMU, or an array, which is
    recorded element by element. A port in place of a pattern is recorded whatever it is. Raises
    `GraphError` where a pattern matches nothing.
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
            causal = {name for v in d.outputs for name in d.scalars(v.name)}
            readable = [e for e in readable if e.variable in causal and e.variable in kinds]
            inputs = [end for end in inputs if end in wired]
        offered += [*readable, *inputs]
    chosen: dict[Endpoint, None] = {}
    for pattern in patterns:
        if isinstance(pattern, Endpoint):
            names = descriptions[pattern.component].scalars(pattern.variable)
            chosen.update(dict.fromkeys(Endpoint(pattern.component, name) for name in names))
            continue
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
    held = {c.target for c in system.connections if not c.extrapolation}
    ports = {
        Endpoint(c.name, name): info
        for c in system.components
        if not isinstance(c, FmuComponent)
        for known in (inputs_of(c, descriptions), outputs_of(c, descriptions))
        for name, info in known.items()
    }
    for end in [*plan.recorded, *(end for pair in sources.items() for end in pair)]:
        d = descriptions.get(end.component)
        if d is not None:
            ports[end] = port_info(d.port(end.variable), d)

    cells = cells_of(plan.lowered, descriptions)

    def unit_of(end: Endpoint, hops: int = 8) -> str:
        unit = ports[end].unit
        if unit is None and end in sources and hops:
            return unit_of(sources[end], hops - 1)
        return unit.name if unit is not None else ""

    def type_of(end: Endpoint) -> str:
        d = descriptions.get(end.component)
        return cells.get(end, "real") if d is None else column_type(d, end.variable)

    def items_of(end: Endpoint) -> tuple[tuple[int, str], ...]:
        d = descriptions.get(end.component)
        return () if d is None else d.port(end.variable).details.items

    def is_held(end: Endpoint) -> bool:
        """Whether it changes at samples only: what is sampled, and what comes in by a held wire."""
        return end.component not in descriptions or end in held

    def name_of(end: Endpoint) -> str:
        return bare_name(end.component, end.variable) if system.single else str(end)

    return tuple(
        Column(
            name_of(end),
            unit_of(end),
            ports[end].description,
            type_of(end),
            is_held(end),
            items_of(end),
        )
        for end in plan.recorded
    )


def column_type(d: ModelDescription, name: str) -> str:
    """The type of the column of a variable or an element."""
    kind = d.port(name).type
    if kind == "Enumeration" and d.fmi_major == 3:
        return "int64"
    return _TYPES.get(kind, "integer")


def select(d: ModelDescription, patterns: Sequence[str] | None) -> tuple[Variable, ...]:
    """The variables to record: those that match one of `patterns` (exact names, or with * and
    ?), or the outputs, or the states of an FMU without outputs, or else its local variables.
    Raises `UsageError` for a pattern that matches nothing."""
    usable = [v for v in d.variables.values() if v.causality != "independent"]
    if patterns is None:
        states = {name for name, _ in d.states}
        for chosen in (
            [v for v in usable if v.causality == "output"],
            [v for v in usable if v.name in states],
            [v for v in usable if v.causality == "local" and v.variability != "constant"],
        ):
            if chosen:
                return tuple(chosen)
        return tuple(usable)
    found: dict[str, Variable] = {}
    for pattern in patterns:
        named = d.variables.get(pattern)
        matching = [named] if named is not None else _matching(usable, pattern)
        if not matching:
            raise UsageError(
                f"nothing to record matches {pattern!r}: "
                f"{nearest(pattern, [v.name for v in usable])}"
            )
        found |= {v.name: v for v in matching if v.causality != "independent"}
    return tuple(found.values())


def _matching(variables: Sequence[Variable], pattern: str) -> list[Variable]:
    literal = pattern.replace("[", "[[]")  # brackets are part of names here
    return [v for v in variables if fnmatchcase(v.name, literal)]
