"""The columns of a recording: their types in memory, and in the schema of its files."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from harness.errors import RecordingError

TIME = "time"

_DTYPES: dict[str, Any] = {
    "real": np.float64, "float32": np.float32, "boolean": np.bool_, "clock": np.bool_,
    "integer": np.int64, "int64": np.int64, "uint64": np.uint64,
}  # fmt: skip
_ELEMENT = re.compile(r"(.+)\[(\d+(?:,\d+)*)\]")
Values = NDArray[Any] | tuple[str, ...]
"""What a column holds: numbers, or texts (binaries hexadecimal)."""
TEXT_TYPES = ("text", "binary")
TYPES = (*_DTYPES, *TEXT_TYPES)


@dataclass(frozen=True)
class Column:
    """One recorded signal: `name` (`instance.variable` in a system), `unit`, `description`.

    `type` says what a row's 8-byte cell holds. Of "real", "float32", "integer" (float64 holds it
    exactly), "boolean" and "clock" (whether it ticks): the value as float64. Of "int64" and
    "uint64": the integer itself. Of "text" and "binary": an index (int64) into the texts of the
    run. `held`: a number keeps its value until the next row, as a discrete variable does. `items`:
    names of an enumeration by number.
    """

    name: str
    unit: str = "1"
    description: str = ""
    type: str = "real"
    held: bool = False
    items: tuple[tuple[int, str], ...] = ()

    def __post_init__(self) -> None:
        """A manifest holds lists."""
        object.__setattr__(self, "items", tuple((number, name) for number, name in self.items))

    @property
    def dtype(self) -> Any:
        """The numpy type of its values, None for texts and binaries."""
        return _DTYPES.get(self.type)

    @property
    def continuous(self) -> bool:
        """Whether it changes between two rows; what does not is held until the next one."""
        return self.type in ("real", "float32") and not self.held


class Trajectory(Protocol):
    """What can be drawn: a `Result`, or what has its times and columns."""

    @property
    def time(self) -> NDArray[np.float64]:
        """Times (s, shape (n,))."""

    def __contains__(self, name: object) -> bool: ...

    def numbers(self, name: str) -> NDArray[np.float64]:
        """The values of a name, shape (n,)."""

    def unit(self, name: str) -> str:
        """The unit of a name."""

    def column(self, name: str) -> Column:
        """The column of a name."""


def check_columns(columns: Iterable[Column]) -> tuple[Column, ...]:
    """The columns as a tuple; raises `RecordingError` where two share a name, one is `time` or its
    type is none."""
    checked = tuple(columns)
    seen: set[str] = set()
    for column in checked:
        if not column.name or column.name == TIME:
            raise RecordingError(
                f"a recorded column may not be called {column.name!r}; the harness writes the "
                "column 'time' itself"
            )
        if column.name in seen:
            raise RecordingError(f"two recorded columns are called {column.name!r}; rename one")
        if column.type not in TYPES:
            raise RecordingError(
                f"column {column.name!r} is of type {column.type!r}; expected {', '.join(TYPES)}"
            )
        seen.add(column.name)
    return checked


def bare_name(instance: str, variable: str) -> str:
    """The column of a variable where only one FMU is recorded: its own name, or
    `instance.variable` for a variable that is called as the column of the time."""
    return f"{instance}.{variable}" if variable == TIME else variable


def array_shapes(names: Iterable[str]) -> dict[str, tuple[int, ...]]:
    """The sizes of the arrays whose elements are among the `names` of columns."""
    shapes: dict[str, tuple[int, ...]] = {}
    for name in names:
        if found := _ELEMENT.fullmatch(name):
            place = tuple(map(int, found[2].split(",")))
            shapes[found[1]] = max(place, shapes.get(found[1], place))
    return shapes


def values_of(
    column: Column, cells: NDArray[np.float64], texts: Sequence[str | bytes]
) -> NDArray[Any] | list[str | bytes]:
    """What the `cells` (contiguous, shape (n,)) of a column stand for; raises `RecordingError`."""
    if column.type in TEXT_TYPES:
        places = cells.view(np.int64)
        wrong = places[(places < 0) | (places >= len(texts))]
        if wrong.size:
            raise RecordingError(
                f"column {column.name!r} got the text number {wrong[0]} of {len(texts)} texts"
            )
        return [texts[place] for place in places.tolist()]
    if column.type in ("int64", "uint64"):
        whole: NDArray[Any] = cells.view(column.dtype)
        return whole
    return cells.astype(column.dtype, copy=False)


def texts_of(values: Iterable[str | bytes]) -> tuple[str, ...]:
    """Strings as they are, binaries hexadecimal."""
    return tuple(one.hex() if isinstance(one, bytes) else one for one in values)


def arrow_array(values: NDArray[Any] | Sequence[str | bytes], kind: Any = None) -> Any:
    """The values of a column as an Arrow array, of the Arrow type `kind` where that is given.

    Numbers are taken as they lie in memory: pyarrow's own way imports pandas.
    """
    import pyarrow as pa

    if not isinstance(values, np.ndarray):
        return pa.array(values, kind)
    truth = values.dtype == np.bool_
    data = np.packbits(values, bitorder="little") if truth else np.ascontiguousarray(values)
    kind, size = kind or pa.from_numpy_dtype(values.dtype), len(values)
    return pa.Array.from_buffers(kind, size, [None, pa.py_buffer(data)])


def values_in(column: Any) -> Values:
    """What a chunked Arrow column holds, again without pandas."""
    import pyarrow as pa

    if pa.types.is_string(column.type) or pa.types.is_binary(column.type):
        return texts_of(column.to_pylist())
    truth = pa.types.is_boolean(column.type)
    plain = (column.cast(pa.uint8()) if truth else column).combine_chunks()
    found: NDArray[Any] = np.from_dlpack(plain)
    return found.view(np.bool_) if truth else found


def schema_of(columns: Sequence[Column]) -> Any:
    """The Arrow schema of rows in files: `time` in seconds, then the columns in their own type."""
    import pyarrow as pa

    def type_of(column: Column) -> Any:
        if column.type in TEXT_TYPES:
            return pa.string() if column.type == "text" else pa.binary()
        return pa.from_numpy_dtype(column.dtype)

    time = pa.field(TIME, pa.float64(), metadata={"unit": "s", "description": "simulated time"})
    fields = [
        pa.field(c.name, type_of(c), metadata={"unit": c.unit, "description": c.description})
        for c in columns
    ]
    return pa.schema([time, *fields])
