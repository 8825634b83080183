"""Rows that get and set variables of an FMU: one call for all ports of one C type that lie side by
side in memory.

Variables that share a value reference are asked for one by one in that call, so each has its value;
the elements of an array have one reference in common, which is given once. FMI 1 names what has
the opposite sign of another one; its slot has the sign of its own name.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np

from harness.compiler import operations as op
from harness.errors import HarnessError
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.description.model_description import Variable
from harness.participants.memory import Memory, Row, View
from harness.system.graph import Descriptions, Endpoint

FLOAT64, WIDE, TEXT = -1, -2, -3
"""Kinds that need no encoding: what lies in a slot as it does in C; and texts."""

_PLAIN = {
    "Real": ("Real", FLOAT64),
    "Integer": ("Integer", op.INT32),
    "Enumeration": ("Integer", op.INT32),
    "Boolean": ("Boolean", op.BOOL32),
    "String": ("String", TEXT),
}
_FMI3 = {
    kind: (kind, code)
    for kind, code in (
        ("Float64", FLOAT64), ("Float32", op.FLOAT32), ("Int8", op.INT8), ("UInt8", op.UINT8),
        ("Int16", op.INT16), ("UInt16", op.UINT16), ("Int32", op.INT32), ("UInt32", op.UINT32),
        ("Int64", WIDE), ("UInt64", WIDE), ("Boolean", op.BOOL8), ("Clock", op.BOOL8),
        ("String", TEXT), ("Binary", TEXT),
    )
} | {"Enumeration": ("Int64", WIDE)}  # fmt: skip
_KINDS = {1: _PLAIN | {"Boolean": ("Boolean", op.BOOL8)}, 2: _PLAIN, 3: _FMI3}
_FAILED = 3  # a status that ends the run


def access(variable: Variable, fmi_major: int) -> tuple[str, int]:
    """Suffix of the get and set functions of a variable, and the kind of its C type."""
    return _KINDS[fmi_major][variable.type]


def scalar_ports(ends: Iterable[Endpoint], descriptions: Descriptions) -> list[Endpoint]:
    """The ports of FMUs, with all elements of an array for any of them, each once, in order."""
    found = (
        Endpoint(end.component, name)
        for end in ends
        for name in descriptions[end.component].scalars(end.variable)
    )
    return list(dict.fromkeys(found))


@dataclass(frozen=True)
class _Group:
    suffix: str
    kind: int
    negated: bool
    ends: tuple[Endpoint, ...]
    first: int

    @property
    def negation(self) -> tuple[float, float]:
        """Factor and offset of a negated alias: -x of numbers, 1 - x of booleans."""
        return -1.0, float(self.suffix == "Boolean")


class Access:
    """Makes the rows for one instance."""

    def __init__(
        self, name: str, instance: FmuInstance, memory: Memory, allow_not_finite: bool = False
    ) -> None:
        """`name` is that of the component."""
        self.allow_not_finite = allow_not_finite
        self.name, self.instance, self.memory = name, instance, memory
        self.description = instance.description
        self.fault: BaseException | None = None

    def read(self, variables: Sequence[str], view: View = "present") -> Iterator[Row]:
        """Get variables into their slots; reals must be finite. What depends on a clock is read
        when that ticks, by whoever lets it tick."""
        variables = [name for name in variables if not self._clocked(name)]
        for group in self._groups(variables, view):
            yield from self._rows("Get", group)
            n = len(group.ends)
            if group.negated:
                slots = range(group.first, group.first + n)
                yield self.memory.copy(slots, slots, [group.negation] * n)
            if group.kind == op.FLOAT32 and not self.allow_not_finite:
                yield [op.CHECK, group.first, n]

    def write(self, variables: Sequence[str]) -> Iterator[Row]:
        """Set variables to what is in their slots."""
        for group in self._groups(variables, "present"):
            if group.negated:
                slots = range(group.first, group.first + len(group.ends))
                other = self.memory.scratch(len(slots))
                yield self.memory.copy(slots, other, [group.negation] * len(slots))
                group = _Group(group.suffix, group.kind, True, group.ends, other[0])
            yield from self._rows("Set", group)

    def _groups(self, variables: Sequence[str], view: View) -> Iterator[_Group]:
        d = self.description

        def slot(end: Endpoint) -> int:
            return self.memory.slot(end, view)

        def neighbours(place: tuple[int, Endpoint]) -> tuple[tuple[str, int], bool, int]:
            i, end = place
            port = d.port(end.variable)
            return access(port, d.fmi_major), port.details.negated, slot(end) - i

        ports = (Endpoint(self.name, name) for name in variables)
        ends = sorted(scalar_ports(ports, {self.name: d}), key=slot)
        for ((suffix, kind), negated, _), group in groupby(enumerate(ends), key=neighbours):
            members = tuple(end for _, end in group)
            yield _Group(suffix, kind, negated, members, slot(members[0]))

    def _clocked(self, name: str) -> bool:
        port = self.description.port(name)
        return port.type == "Clock" or bool(port.details.clocks)

    def references(self, ends: Sequence[Endpoint]) -> Any:
        """The value references of ports, uint32: of an array one for all of its elements."""
        return np.array([v.value_reference for v in self._owners(ends)], dtype=np.uint32)

    def _owners(self, ends: Sequence[Endpoint]) -> list[Variable]:
        """The variables to which ports belong, each array once."""
        names = dict.fromkeys(self.description.owner(end.variable) for end in ends)
        return [self.description.variable(name) for name in names]

    def _rows(self, verb: str, group: _Group) -> Iterator[Row]:
        if group.kind == TEXT:
            yield self._text(verb, group)
            return
        instance, n = self.instance, len(group.ends)
        references = self.references(group.ends)
        start, values = 0, self.memory.address(group.first)
        encoded = group.kind not in (FLOAT64, WIDE)
        if encoded:
            start, values = self.memory.reserve(n * op.ITEM_SIZE[group.kind])
        head = [instance.address(verb + group.suffix), instance.handle or 0]
        call = [*head, self.memory.constant(references), len(references), values]
        code = [group.kind, group.first, group.first + n, start]
        if encoded and verb == "Set":
            yield [op.ENCODE, *code]
        sized = instance.prefix == "fmi3" and group.suffix != "Clock"
        if verb == "Set":
            yield [op.SET_FMI3, *call, n] if sized else [op.SET_FMI2, *call]
        else:
            address, *rest = call
            checked = n if group.kind == FLOAT64 and not self.allow_not_finite else 0
            yield [op.GET_FMI3 if sized else op.GET_FMI2, address, checked, *rest, n]
        if encoded and verb == "Get":
            yield [op.DECODE, *code]

    def _text(self, verb: str, group: _Group) -> Row:
        """A call of Python that gets or sets texts: an FMU's strings live until its next call."""
        memory = self.memory
        bound = self.instance.group(*self._owners(group.ends))
        cell = memory.cell(group.ends[0])
        empty: str | bytes = "" if cell == "text" else b""
        slots = slice(group.first, group.first + len(group.ends))

        def transfer() -> int:
            try:
                if verb == "Get":
                    memory.wide[slots] = [memory.texts.number(text) for text in bound.read()]
                else:
                    numbers = memory.wide[slots].tolist()
                    bound.write([memory.texts.entries[i] if i > 1 else empty for i in numbers])
            except HarnessError as fault:
                self.fault = fault
                return _FAILED
            return 0

        return [op.CALL_4, memory.function(transfer), 0, 0, 0, 0]
