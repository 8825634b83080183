"""A signal read from a CSV file, and the liberal reading of the CSV files of this field.

Accepted: cells between commas, tabs or semicolons (then also with decimal commas), a byte-order
mark, quoted and unquoted names, spaces after the comma, a first line `"sep=,"`, `Time` beside
`time`, a counter column, names with a tail (`x [0 real output]`, `inst::x[REAL]`), `True` and
`False`. Times are in seconds and must not decrease; at a time that
repeats (both sides of an event) the later row holds.
"""

from __future__ import annotations

import csv
import os
import re
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from harness.clock import LONGEST, NANOSECONDS
from harness.errors import ExperimentError, nearest
from harness.instruments.checks import Waveform, check_choice, label, require
from harness.instruments.source import Times, Values

TYPE_TAIL = re.compile(r"\s*\[(\d+ \w+ \w+|REAL|INT|BOOL|STR|STRING|INTEGER|BOOLEAN)\]$")
_DELIMITERS = ",;\t"
_DECIMAL_COMMA = r"^(\s*[-+]?\d*),(\d+([eE][-+]?\d+)?\s*)$"
Interpolation = Annotated[str, partial(check_choice, legal=("hold", "linear"))]


@dataclass(frozen=True, eq=False)
class CsvTable:
    """The columns of a CSV file; `columns` is a pyarrow Table without its own names."""

    path: Path
    names: tuple[str, ...]
    columns: Any

    @cached_property
    def times_ns(self) -> Times:
        """The instants of the rows (integer nanoseconds, shape (n,))."""
        if not np.all(np.abs(self.seconds) <= LONGEST):
            raise ExperimentError(f"{self.path} has times beyond {LONGEST:g} s")
        return np.rint(self.seconds * NANOSECONDS).astype(np.int64)

    @cached_property
    def seconds(self) -> Values:
        """The times of the rows (s, shape (n,)), which do not decrease."""
        seconds = self._numbers(self.time_index)
        if len(seconds) == 0:
            raise ExperimentError(f"{self.path} has a header but no rows of values")
        backwards = np.flatnonzero(np.diff(seconds) < 0.0)
        if len(backwards):
            row = int(backwards[0]) + 1
            raise ExperimentError(
                f"{self.path}: time goes back from {seconds[row - 1]:.9g} s to "
                f"{seconds[row]:.9g} s in row {row + 1} of the values; times must not decrease"
            )
        return seconds

    @cached_property
    def time_index(self) -> int:
        """The place of the column of the time."""
        for index, name in enumerate(self.names):
            if _lowered(name) == "time":
                return index
        raise ExperimentError(
            f"{self.path} has no column 'time', only {', '.join(map(repr, self.names[:12]))}"
        )

    def column(self, name: str) -> Values:
        """The values of the column called `name` (exactly, else by its plain name), shape (n,)."""
        return self._numbers(self._index(name))

    def _numbers(self, index: int) -> Values:
        import pyarrow as pa
        import pyarrow.compute as pc

        name, cells = self.names[index], self.columns.column(index)
        try:
            if pa.types.is_string(cells.type):
                cells = pc.utf8_trim_whitespace(cells)
            values = cells.cast("float64").to_numpy()
        except (ValueError, NotImplementedError) as fault:
            reason = " ".join(str(fault).split())[:300]
            raise ExperimentError(
                f"{self.path}: column {name!r} holds something that is no number ({reason})"
            ) from fault
        odd = np.flatnonzero(~np.isfinite(values))
        if len(odd):
            row = int(odd[0])
            what = "no number" if np.isnan(values[row]) else f"{values[row]}"
            raise ExperimentError(
                f"{self.path}: column {name!r} has {what} in row {row + 1} of the values"
            )
        return np.asarray(values, dtype=np.float64)

    def _index(self, name: str) -> int:
        exact = [i for i, one in enumerate(self.names) if one == name]
        alike = exact or [i for i, one in enumerate(self.names) if plain_name(one) == name]
        if not alike:
            raise ExperimentError(
                f"{self.path} has no column {name!r}: {nearest(name, map(plain_name, self.names))}"
            )
        if len(alike) > 1:
            raise ExperimentError(
                f"{self.path} has {len(alike)} columns called {name!r}; rename all but one"
            )
        return alike[0]


def plain_name(name: str) -> str:
    """A column's name without a type tail and with `instance.variable` for `instance::variable`."""
    return TYPE_TAIL.sub("", name.strip()).replace("::", ".")


def read_csv_table(path: Path, *, as_text: bool = False) -> CsvTable:
    """The CSV file at `path`, its cells as they stand where `as_text`; raises `ExperimentError`
    where it cannot be read."""
    import pyarrow as pa
    import pyarrow.compute as pc
    import pyarrow.csv as arrow_csv

    try:
        names, skipped, delimiter = _header(path)
        as_text = as_text or delimiter == ";"
        types = {name: pa.string() for name in names} if as_text else {}
        table = arrow_csv.read_csv(
            path,
            read_options=arrow_csv.ReadOptions(skip_rows=skipped, column_names=list(names)),
            parse_options=arrow_csv.ParseOptions(delimiter=delimiter),
            convert_options=arrow_csv.ConvertOptions(
                column_types=types,
                true_values=["True", "true", "TRUE"],
                false_values=["False", "false", "FALSE"],
            ),
        )
    except ExperimentError:
        raise
    except UnicodeDecodeError as fault:
        raise ExperimentError(f"{path} is no text in UTF-8: {fault}") from fault
    except (csv.Error, pa.ArrowException, ValueError, TypeError) as fault:
        if "Empty CSV" in str(fault):
            raise ExperimentError(f"{path} has a header but no rows of values") from fault
        reason = " ".join(str(fault).split())[:300]
        raise ExperimentError(f"{path} cannot be read as CSV: {reason}") from fault
    except OSError as fault:
        raise ExperimentError(f"{path} cannot be read: {fault}") from fault
    if delimiter == ";":
        points = (
            pc.replace_substring_regex(one, _DECIMAL_COMMA, r"\1.\2") for one in table.columns
        )
        table = pa.table(list(points), names=list(names))
    return CsvTable(path, names, table)


def _header(path: Path) -> tuple[tuple[str, ...], int, str]:
    """Names, number of lines before the values, and the delimiter: the one that is declared, else
    the first one that makes a cell of the time."""
    delimiters = _DELIMITERS
    with path.open(encoding="utf-8-sig", newline="") as lines:
        for count, line in enumerate(lines, start=1):
            text = line.strip()
            declared = re.fullmatch(r'"?sep=(.)"?', text)
            if declared:
                delimiters = declared[1]
            elif text:
                found = {mark: _cells(text, mark) for mark in delimiters}
                timed = [m for m, names in found.items() if "time" in map(_lowered, names)]
                delimiter = (timed or list(delimiters))[0]
                return found[delimiter], count, delimiter
    raise ExperimentError(f"{path} is empty; a header with the column 'time' was expected")


def _cells(line: str, delimiter: str) -> tuple[str, ...]:
    cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    return tuple(cell.strip() for cell in cells)


def _lowered(name: str) -> str:
    return plain_name(name).lower()


@dataclass(frozen=True)
class CsvSignal(Waveform, kind="csv"):
    """Column `column` of the CSV file `file`, held between rows or interpolated (`hold`,
    `linear`); the first value holds before the first row, the last one after the last."""

    file: str | os.PathLike[str]
    column: str
    interpolation: Interpolation = "hold"

    def _settle(self) -> None:
        if not isinstance(self.file, str | os.PathLike) or not Path(self.file).is_file():
            raise ExperimentError(f"{label(self)}: 'file' is no existing file: {self.file!r}")
        require(self, "column", isinstance(self.column, str), "be a name")
        self._rows  # noqa: B018  (a file with a fault is reported here, not in the run)

    @cached_property
    def _rows(self) -> tuple[Times, Values]:
        table = read_csv_table(Path(self.file))
        return table.times_ns, table.column(self.column)

    def at(self, times_ns: Times) -> Values:
        """The values at `times_ns` (ns, shape (n,))."""
        times, values = self._rows
        after = np.searchsorted(times, times_ns, "right")
        left = np.maximum(after - 1, 0)
        if self.interpolation == "hold":
            return values[left]
        right = np.minimum(after, len(times) - 1)
        gap = np.maximum(times[right] - times[left], 1)
        share = np.where(left == right, 0.0, (times_ns - times[left]) / gap)
        return values[left] + share * (values[right] - values[left])
