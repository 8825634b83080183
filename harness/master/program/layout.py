"""Where everything lies in memory: one slot for every port that a plan touches, and what it holds.

The ports of a component that are handed over in one call lie side by side: the inputs and the
outputs of a block, and the inputs or outputs of an FMU that have the same C type. Ports of plain
Python hold what they are wired to.
"""

from __future__ import annotations

from collections.abc import Iterable

from harness.master.plan.actions import Keep, Read, flat
from harness.master.plan.planner import Plan
from harness.participants.access import access, scalar_ports
from harness.participants.memory import Cell, Layout, View, cell_of
from harness.system.graph import Descriptions, Endpoint, PythonComponent
from harness.system.lowering import LoweredSystem


def cells_of(lowered: LoweredSystem, descriptions: Descriptions) -> dict[Endpoint, Cell]:
    """What the slots of FMUs' ports hold, and those of plain Python by their wires; reals are not
    listed."""
    python = {c.name for c in lowered.components if isinstance(c, PythonComponent)}
    found: dict[Endpoint, Cell] = {}

    def of(end: Endpoint) -> Cell:
        d = descriptions.get(end.component)
        return found.get(end, "real") if d is None else cell_of(d.port(end.variable), d.fmi_major)

    wires = lowered.wires
    for wire in wires:  # outputs of plain Python first: one may feed another one
        if wire.source.component in python and wire.target.component in descriptions:
            found.setdefault(wire.source, of(wire.target))
    for wire in wires:
        if wire.target.component in python:
            found[wire.target] = of(wire.source)
    return {end: cell for end, cell in found.items() if cell != "real"}


def make_layout(plan: Plan, descriptions: Descriptions) -> Layout:
    """Give a slot to every port that `plan` touches."""

    def grouped(ends: Iterable[Endpoint]) -> list[Endpoint]:
        def key(end: Endpoint) -> tuple[str, str, bool]:
            d = descriptions[end.component]
            port = d.port(end.variable)
            return end.component, access(port, d.fmi_major)[0], port.details.negated

        return sorted(scalar_ports(ends, descriptions), key=key)

    slots: dict[Endpoint, int] = {}
    for end in [*grouped(plan.written), *grouped(plan.read)]:
        slots.setdefault(end, len(slots))
    for component in plan.lowered.sampled:
        for signals in (component.inputs, component.outputs):
            for signal in signals:
                slots[Endpoint(component.name, signal.name)] = len(slots)
    rank = {end: i for i, end in enumerate(slots)}
    others: set[tuple[View, Endpoint]] = {
        (action.view, one)
        for action in set(flat(plan.actions))
        if isinstance(action, (Keep, Read)) and action.view != "present"
        for one in scalar_ports(action.ends, descriptions)
    }
    ordered = sorted(others, key=lambda other: (other[0], rank[other[1]]))
    views = {other: len(slots) + i for i, other in enumerate(ordered)}
    cells = cells_of(plan.lowered, descriptions)
    for end in slots:
        d = descriptions.get(end.component)
        cell = "real" if d is None else cell_of(d.port(end.variable), d.fmi_major)
        if cell != "real":
            cells[end] = cell
    return Layout(slots, views, cells)
