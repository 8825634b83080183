"""The memory of one program as participants see it: slots, bytes for C numbers, texts.

A slot is a cell of 8 bytes. What it holds depends on the type of its port (`Cell`): reals, booleans
and integers up to 32 bits are float64; 64-bit integers are themselves; strings and binaries are
numbers of entries in the table of texts. All memory to which a program holds addresses lives as
long as the program.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from harness.compiler import operations as op
from harness.fmi.description.model_description import Variable
from harness.system.graph import Endpoint

Row = list[int]
"""A row of a program: an opcode of `operations` and its operands."""
View = Literal["present", "applied", "reached", "previous", "event"]
"""Which values of an FMU's outputs: those read at the present instant, those after the inputs of
this instant have been applied (where outputs depend on them directly), those at the end of the
step, those of the instant before, or those at an event inside a step. Each is held until it is
read again."""
Cell = Literal["real", "int64", "uint64", "text", "binary"]

_WIDE: dict[str, Cell] = {
    "Int64": "int64", "UInt64": "uint64", "String": "text", "Binary": "binary",
}  # fmt: skip


def cell_of(variable: Variable, fmi_major: int) -> Cell:
    """What the slot of a variable holds."""
    if variable.type == "Enumeration" and fmi_major == 3:
        return "int64"
    return _WIDE.get(variable.type, "real")


class Texts:
    """The strings and binaries of a run, each once; `added` is told of every new one.

    Number 0 is the empty string, number 1 the empty binary.
    """

    def __init__(self) -> None:
        self.entries: list[str | bytes] = ["", b""]
        self.added: Callable[[str | bytes], None] = lambda entry: None
        self._numbers: dict[str | bytes, int] = {"": 0, b"": 1}

    def number(self, entry: str | bytes) -> int:
        """The number of `entry`, a new one where it was not seen before."""
        number = self._numbers.get(entry)
        if number is None:
            number = self._numbers[entry] = len(self.entries)
            self.entries.append(entry)
            self.added(entry)
        return number

    def replace(self, entries: Sequence[str | bytes]) -> None:
        """Become the table of a run that has come further, of which `added` need not be told."""
        self.entries[:] = entries
        self._numbers = {entry: number for number, entry in enumerate(entries)}


@dataclass(frozen=True)
class Layout:
    """Slots by port: those of the present, and those of FMU outputs in another view; what they
    hold, where that is no real number."""

    slots: Mapping[Endpoint, int] = field(default_factory=dict)
    views: Mapping[tuple[View, Endpoint], int] = field(default_factory=dict)
    cells: Mapping[Endpoint, Cell] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """The number of slots."""
        return len(self.slots) + len(self.views)

    def slot(self, end: Endpoint, view: View = "present") -> int:
        """The slot of a port in a view, of its present value where it has none in that view."""
        return self.views.get((view, end), self.slots[end])

    def cell(self, end: Endpoint) -> Cell:
        """What the slots of a port hold."""
        return self.cells.get(end, "real")

    def places(self) -> Iterator[tuple[Endpoint, int]]:
        """All slots with their ports."""
        yield from self.slots.items()
        yield from ((end, place) for (_, end), place in self.views.items())


class Memory:
    """What `link` gives to participants.

    v          float64 (n_slots,), every signal of the system; `wide` are the same cells as int64
    clock      int64, the loop's own state
    exchange   uint8, where C numbers are encoded and decoded
    """

    def __init__(
        self, layout: Layout, clock: NDArray[np.int64], scratch: int = 0, exchange: int = 8
    ) -> None:
        """Room for the slots of `layout`, so many that belong to no port, and so many bytes."""
        self.v = np.zeros(max(1, layout.size + scratch))
        self.wide = self.v.view(np.int64)
        self.exchange = np.zeros(exchange, dtype=np.uint8)
        self.clock, self.layout = clock, layout
        self.slot, self.cell = layout.slot, layout.cell
        self.texts = Texts()
        self.lives: list[Any] = []
        self._constants: dict[tuple[Any, bytes], NDArray[Any]] = {}
        self._exchange_used = 0
        self._slots_used = layout.size
        self._copies: list[tuple[int, int, int]] = []
        self._scales: list[tuple[float, float]] = []

    def address(self, slot: int) -> int:
        """Where a slot lies."""
        return int(self.v.ctypes.data) + 8 * slot

    def scratch(self, n: int) -> range:
        """Slots that belong to no port."""
        first, self._slots_used = self._slots_used, self._slots_used + n
        assert self._slots_used <= self.v.size
        return range(first, first + n)

    def reserve(self, n_bytes: int) -> tuple[int, int]:
        """Room in the exchange buffer: its offset (a multiple of 8) and its address."""
        start = self._exchange_used
        self._exchange_used += -(-n_bytes // 8) * 8
        assert self._exchange_used <= self.exchange.size
        return start, int(self.exchange.ctypes.data) + start

    def copy(
        self,
        sources: Sequence[int],
        targets: Sequence[int],
        scales: Sequence[tuple[float, float]] | None = None,
        code: int = op.SCALE,
        conversions: Sequence[int] | None = None,
    ) -> Row:
        """Copy (or add) slots to slots, by (factor, offset); without scales as they are.

        What is copied at once is a stretch of one table, and one operation.
        """
        first = len(self._copies)
        by = [op.EXACT] * len(sources) if conversions is None else conversions
        self._copies += zip(sources, targets, by, strict=True)
        self._scales += [(1.0, 0.0)] * len(sources) if scales is None else scales
        return [op.COPY if scales is None else code, first, len(sources)]

    @property
    def copies(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Source, destination and conversion (n, 3), factors and offsets (n, 2) of all copies."""
        return (
            np.array(self._copies, dtype=np.int64).reshape(-1, 3),
            np.array(self._scales, dtype=np.float64).reshape(-1, 2),
        )

    def held(self, array: NDArray[Any]) -> int:
        """The address of an array that lives as long as the program."""
        self.lives.append(array)
        return int(array.ctypes.data)

    def constant(self, array: NDArray[Any]) -> int:
        """The same of one that nobody changes: equal ones are one, which is read faster."""
        return self.held(self._constants.setdefault((array.dtype, array.tobytes()), array))

    def function(self, call: Callable[..., int], *types: Any) -> int:
        """The address of a C function that calls Python, with arguments of these types of ctypes;
        it lives as long as the program."""
        made = ctypes.CFUNCTYPE(ctypes.c_int, *types)(call)
        self.lives.append(made)
        return ctypes.cast(made, ctypes.c_void_p).value or 0

    def store(self, end: Endpoint, value: Any, view: View = "present") -> None:
        """Put a Python value into the slot of a port."""
        slot, cell = self.slot(end, view), self.cell(end)
        if cell == "real":
            self.v[slot] = float(value)
        else:
            self.wide[slot] = raw(value, cell, self.texts)


def raw(value: Any, cell: Cell, texts: Texts) -> int:
    """The 64 bits, as a signed integer, of a value in a slot that is not real; raises
    `ValueError`, `TypeError` or `OverflowError` where it does not fit."""
    if cell == "text":
        if not isinstance(value, str):
            raise TypeError(f"expected a str, not {value!r}")
        return texts.number(value)
    if cell == "binary":
        return texts.number(bytes(value))
    whole = int(value)
    if whole != value:
        raise ValueError(f"{value!r} is no whole number")
    low, high = (-(2**63), 2**63) if cell == "int64" else (0, 2**64)
    if not low <= whole < high:
        raise OverflowError(f"{whole} does not fit into {cell}")
    return whole if whole < 2**63 else whole - 2**64


def loaded(memory: Memory, slot: int, cell: Cell) -> Any:
    """The value in a slot: a float, an int, a str or bytes."""
    if cell == "real":
        return float(memory.v[slot])
    bits = int(memory.wide[slot])
    if cell in ("text", "binary"):
        return memory.texts.entries[bits]
    return bits if cell == "int64" or bits >= 0 else bits + 2**64
