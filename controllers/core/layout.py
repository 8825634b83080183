"""Where the parts of a block's flat arrays lie: declared once, for whoever fills them and the step.

    STATE = Layout.of(seen=(), gamma=3, theta=(3, "n"), work="work")

declares a number, three numbers, a matrix of 3 rows, and as many numbers as "work" will say. The
side that makes a block fills parts by name, `STATE.fill({"theta": rows}, n=4, work=9)`. The side
of the step, which sees floats alone, has two ways, both legal in compiled, native and exported
code:

    S_GAMMA = STATE.place("gamma")       a constant, where the sizes before the part are numbers
    THETA = STATE.number("theta")        a number, for `part` and `row_of`, with the table of places
                                         `STATE.table(n=4, work=9)` that the block carries in p

This module refuses to know what the parts mean.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import takewhile

import numpy as np
from numpy.typing import ArrayLike

from controllers.core.block import Array
from controllers.core.errors import ControllerError, require

Size = int | str


@dataclass(frozen=True)
class Layout:
    """Names and shapes of parts that lie one after the other; a size is a number or a name."""

    shapes: tuple[tuple[str, tuple[Size, ...]], ...]

    @classmethod
    def of(cls, **shapes: Size | tuple[Size, ...]) -> Layout:
        """The layout of parts in this order; `()` is a single number, `n` short for `(n,)`."""
        tuples = ((k, s if isinstance(s, tuple) else (s,)) for k, s in shapes.items())
        return cls(tuple(tuples))

    @property
    def names(self) -> tuple[str, ...]:
        """The parts in their order."""
        return tuple(name for name, _ in self.shapes)

    @property
    def entries(self) -> int:
        """Length of the table of places."""
        return len(self.shapes) + 1

    @property
    def length(self) -> int:
        """Length of the array; raises `ControllerError` where a size is not known."""
        return int(self.table()[-1])

    def number(self, name: str) -> int:
        """Which part it is, counted from 0; raises `ControllerError` for one not declared."""
        require(name in self.names, "Layout", "one of " + ", ".join(self.names), name)
        return self.names.index(name)

    def place(self, name: str) -> int:
        """Where a part begins; raises `ControllerError` where a size before it is not known."""
        return Layout(self.shapes[: self.number(name)]).length

    def places(self) -> tuple[int, ...]:
        """Where the parts begin, in their order, as far as the sizes before them are numbers."""
        fixed = takewhile(lambda one: all(isinstance(n, int) for n in one[1]), self.shapes)
        return tuple(map(self.place, self.names[: len(tuple(fixed)) + 1]))

    def table(self, start: int = 0, /, **sizes: int) -> Array:
        """Where every part begins, and where the last one ends, (entries,), from `start` on."""
        lengths = [math.prod(self._shape(name, sizes)) for name in self.names]
        return np.cumsum([start, *lengths], dtype=np.float64)

    def fill(self, values: Mapping[str, ArrayLike], /, **sizes: int) -> Array:
        """The flat array; parts without a value are 0.

        Raises `ControllerError` for a part that is not declared and for a value of another shape.
        """
        for name in values:
            self.number(name)
        rows = []
        for name in self.names:
            shape = self._shape(name, sizes)
            value = np.asarray(values.get(name, np.zeros(shape)), dtype=np.float64)
            require(value.shape == shape, f"Layout: {name}", f"shape {shape}", value.shape)
            rows.append(value.ravel())
        return np.concatenate(rows)

    def _shape(self, name: str, sizes: Mapping[str, int]) -> tuple[int, ...]:
        shape = dict(self.shapes)[name]
        for size in shape:
            if isinstance(size, str) and size not in sizes:
                raise ControllerError(f"Layout: {name}: expected the size {size}, received none.")
        return tuple(sizes[size] if isinstance(size, str) else size for size in shape)


def part(table: Array, array: Array, which: int) -> Array:
    """Part number `which` of an array, a view; `table` begins with the places of its layout."""
    return array[int(table[which]) : int(table[which + 1])]


def row_of(matrix: Array, number: int, count: int) -> Array:
    """Row `number` of a part that has `count` rows; a view."""
    size = matrix.shape[0] // count
    return matrix[size * number : size * (number + 1)]
