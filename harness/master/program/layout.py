"""Where everything lies in memory: one float64 slot for every port that a plan touches.

The ports of a component that are handed over in one call lie side by side: the inputs and the
outputs of a block, and the inputs or outputs of an FMU that have the same C type. One call handles
a value reference once, so second names of references come after all first ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from harness.fmi.description.model_description import ModelDescription, Variable
from harness.master.plan.actions import Keep, Read, View, flat
from harness.master.plan.planner import Plan
from harness.master.program import operations as op
from harness.system.graph import Endpoint

FLOAT64 = -1
"""The kind of a number that needs no encoding."""

_FMI2_KINDS = {
    "Real": ("Real", FLOAT64),
    "Integer": ("Integer", op.INT32),
    "Enumeration": ("Integer", op.INT32),
    "Boolean": ("Boolean", op.BOOL32),
}
_FMI3_KINDS = {
    "Float64": ("Float64", FLOAT64),
    "Float32": ("Float32", op.FLOAT32),
    "Int8": ("Int8", op.INT8),
    "UInt8": ("UInt8", op.UINT8),
    "Int16": ("Int16", op.INT16),
    "UInt16": ("UInt16", op.UINT16),
    "Int32": ("Int32", op.INT32),
    "UInt32": ("UInt32", op.UINT32),
    "Int64": ("Int64", op.INT64),
    "UInt64": ("UInt64", op.UINT64),
    "Enumeration": ("Int64", op.INT64),
    "Boolean": ("Boolean", op.BOOL8),
}


def access(variable: Variable, fmi_major: int) -> tuple[str, int]:
    """Suffix of the get and set functions of a variable, and the kind of its C type."""
    return (_FMI2_KINDS if fmi_major == 2 else _FMI3_KINDS)[variable.type]


@dataclass(frozen=True)
class Layout:
    """Slots by port: those of the present, and those of FMU outputs in another view."""

    slots: Mapping[Endpoint, int]
    views: Mapping[tuple[View, Endpoint], int]
    size: int

    def slot(self, end: Endpoint, view: View = "present") -> int:
        """The slot of a port in a view, of its present value where it has none in that view."""
        return self.views.get((view, end), self.slots[end])

    def places(self) -> Iterator[tuple[Endpoint, int]]:
        """All slots with their ports."""
        yield from self.slots.items()
        yield from ((end, place) for (_, end), place in self.views.items())


def whole(ends: Iterable[Endpoint], descriptions: Mapping[str, ModelDescription]) -> list[Endpoint]:
    """The ports of FMUs, with all elements of an array for any of them, each once, in order."""
    return list(
        dict.fromkeys(
            Endpoint(end.component, name)
            for end in ends
            for name in descriptions[end.component].whole(end.variable)
        )
    )


def earlier_names(
    ends: Iterable[Endpoint], descriptions: Mapping[str, ModelDescription]
) -> dict[Endpoint, int]:
    """How many variables before that of each port have the same value reference and C type."""
    names: dict[tuple[str, str, int], list[str]] = {}
    found = {}
    for end in ends:
        d = descriptions[end.component]
        name, port = d.owner(end.variable), d.port(end.variable)
        key = end.component, access(port, d.fmi_major)[0], port.value_reference
        known = names.setdefault(key, [])
        if name not in known:
            known.append(name)
        found[end] = known.index(name)
    return found


def make_layout(plan: Plan, descriptions: Mapping[str, ModelDescription]) -> Layout:
    """Give a slot to every port that `plan` touches."""

    def grouped(ends: Iterable[Endpoint]) -> list[Endpoint]:
        def key(end: Endpoint) -> tuple[str, str, int]:
            d = descriptions[end.component]
            return end.component, access(d.port(end.variable), d.fmi_major)[0], earlier[end]

        touched = whole(ends, descriptions)
        earlier = earlier_names(touched, descriptions)
        return sorted(touched, key=key)

    slots: dict[Endpoint, int] = {}
    for end in [*grouped(plan.written), *grouped(plan.read)]:
        slots.setdefault(end, len(slots))
    for component in plan.lowered.sampled:
        for signals in (component.inputs, component.outputs):
            for signal in signals:
                slots[Endpoint(component.name, signal.name)] = len(slots)
    rank = {end: i for i, end in enumerate(slots)}
    others: set[tuple[View, Endpoint]] = set()
    for action in flat([*plan.initial, *(a for actions in plan.patterns for a in actions)]):
        if isinstance(action, (Keep, Read)):
            view = action.view if isinstance(action, Read) else "previous"
            others |= {(view, Endpoint(action.component, name)) for name in action.outputs}
    others = {
        (view, one)
        for view, end in others
        if view != "present"
        for one in whole([end], descriptions)
    }
    ordered = sorted(others, key=lambda other: (other[0], rank[other[1]]))
    views = {other: len(slots) + i for i, other in enumerate(ordered)}
    return Layout(slots, views, len(slots) + len(views))
