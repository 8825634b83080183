"""Copies along wires, as rows: plain, summed, and converted between what slots hold."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from harness.compiler import operations as op
from harness.master.plan.actions import Blend, Keep, Transfer
from harness.participants.memory import Cell, Memory, Row
from harness.system.graph import Endpoint
from harness.system.lowering import Wire

_CONVERSIONS: dict[tuple[Cell, Cell], int] = {
    ("int64", "real"): op.FROM_INT64,
    ("uint64", "real"): op.FROM_UINT64,
    ("real", "int64"): op.TO_INT64,
    ("real", "uint64"): op.TO_UINT64,
    ("int64", "uint64"): op.INT64_TO_UINT64,
    ("uint64", "int64"): op.UINT64_TO_INT64,
}
Stored = Callable[[Endpoint], int]
"""By which conversion a real is held by the variable behind a port; EXACT where as it is."""


def transfer(memory: Memory, action: Transfer, stored: Stored) -> Iterator[Row]:
    """Copy along wires."""
    plain: list[Wire] = []
    scaled: list[Wire] = []
    typed: list[tuple[Wire, int]] = []
    how: int
    for wire in action.wires:
        cells = memory.cell(wire.source), memory.cell(wire.target)
        if cells == ("real", "real"):
            how = stored(wire.target)
            if how == op.EXACT:
                (plain if (wire.factor, wire.offset) == (1.0, 0.0) else scaled).append(wire)
                continue
        else:
            how = _CONVERSIONS.get(cells, op.EXACT)
        typed.append((wire, how))
    if plain:
        yield memory.copy(*_ends(memory, action, plain))
    if scaled:
        yield memory.copy(*_ends(memory, action, scaled), _scales(scaled))
    if typed:
        wires = [wire for wire, _ in typed]
        conversions = [conversion for _, conversion in typed]
        ends = _ends(memory, action, wires)
        yield memory.copy(*ends, _scales(wires), op.COPY_TYPED, conversions)


def _ends(memory: Memory, action: Transfer, wires: Sequence[Wire]) -> tuple[list[int], list[int]]:
    sources = [memory.slot(wire.source, action.view) for wire in wires]
    return sources, [memory.slot(wire.target) for wire in wires]


def _scales(wires: Sequence[Wire], by: float = 1.0) -> list[tuple[float, float]]:
    return [(by * wire.factor, by * wire.offset) for wire in wires]


def keep(memory: Memory, action: Keep) -> Row:
    """Copy present values to previous ones."""
    present = [memory.slot(end) for end in action.ends]
    return memory.copy(present, [memory.slot(end, action.view) for end in action.ends])


def weigh(
    memory: Memory, action: Blend, into: Sequence[int] | None = None, share: float = 1.0
) -> Iterator[Row]:
    """`share` times the weighted sum of an action, into slots of its own or its targets."""
    targets = [memory.slot(wire.target) for wire in action.wires]
    own = action.own * share
    if into is not None or own != 1.0:
        yield memory.copy(targets, into or targets, [(own, 0.0)] * len(targets))
    for view, weight in action.terms:
        sources = [memory.slot(wire.source, view) for wire in action.wires]
        yield memory.copy(sources, into or targets, _scales(action.wires, weight * share), op.ADD)
