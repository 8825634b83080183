"""The columns of a recording, and how they stand in the schema of its files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from harness.errors import RecordingError

TIME = "time"
TIME_NS = "time_ns"


@dataclass(frozen=True)
class Column:
    """One recorded signal: `name` as `instance.variable`, `unit`, `description`.

    Booleans are recorded as 0 and 1, enumerations as numbers.
    """

    name: str
    unit: str = "1"
    description: str = ""


def check_columns(columns: Iterable[Column]) -> tuple[Column, ...]:
    """The columns as a tuple; raises `RecordingError` where two share a name or one is `time`."""
    checked = tuple(columns)
    seen: set[str] = set()
    for column in checked:
        if not column.name or column.name in (TIME, TIME_NS):
            raise RecordingError(
                f"a recorded column may not be called {column.name!r}; the harness writes the "
                "column 'time' itself"
            )
        if column.name in seen:
            raise RecordingError(f"two recorded columns are called {column.name!r}; rename one")
        seen.add(column.name)
    return checked


def stream_schema(columns: Sequence[Column]) -> Any:
    """The Arrow schema of `rows.arrows`: integer `time_ns`, then the columns as float64."""
    import pyarrow as pa

    time = pa.field(TIME_NS, pa.int64(), metadata={"unit": "ns"})
    return pa.schema([time, *_fields(columns)])


def table_schema(columns: Sequence[Column]) -> Any:
    """The Arrow schema of `results.parquet`: `time` in seconds, then the columns as float64."""
    import pyarrow as pa

    time = pa.field(TIME, pa.float64(), metadata={"unit": "s", "description": "simulated time"})
    return pa.schema([time, *_fields(columns)])


def _fields(columns: Sequence[Column]) -> list[Any]:
    import pyarrow as pa

    return [
        pa.field(
            one.name, pa.float64(), metadata={"unit": one.unit, "description": one.description}
        )
        for one in columns
    ]


def schema_columns(schema: Any) -> tuple[Column, ...]:
    """The columns of a stored schema, without its time column."""
    read = []
    for one in list(schema)[1:]:
        notes = {key.decode(): value.decode() for key, value in (one.metadata or {}).items()}
        read.append(Column(one.name, notes.get("unit", "1"), notes.get("description", "")))
    return tuple(read)
