"""Tables in whatever width there is: texts wrap between words, numbers and names stay as they are,
and columns for which there is no room go below the others, beside the first column again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from harness.cli.terminal import console

if TYPE_CHECKING:
    from rich.table import Column, Table
    from rich.text import Text


def show_table(*tables: Table) -> None:
    """Print tables, each below its title."""
    out = console()
    for table in tables:
        if table.title:
            out.print(table.title, style="italic", soft_wrap=True, markup=False)
        for part in fitted(table, out.width):
            out.print(part, crop=False, overflow="ignore")


def fitted(table: Table, width: int) -> Iterator[Table]:
    """The table without its title, as one where it fits into `width` characters, else in parts."""
    columns = table.columns
    needed = [_narrowest(column) for column in columns]
    frame = _frame(table, 0)
    first, *others = range(len(columns))
    while others:
        room = width - frame - needed[first] - _frame(table, 1)
        taken = 0
        for index in others:
            room -= needed[index] + _frame(table, 1)
            if room < 0:
                break
            taken += 1
        some, others = others[: max(1, taken)], others[max(1, taken) :]
        yield _part(table, [first, *some], needed, width)
    if len(columns) == 1:
        yield _part(table, [first], needed, width)


def _frame(table: Table, columns: int) -> int:
    """Characters besides the cells: of so many columns, or at the edges where it is none."""
    _, right, _, left = table.padding
    return columns * (left + right + (table.box is not None)) if columns else table.box is not None


def _part(table: Table, chosen: Sequence[int], needed: Sequence[int], width: int) -> Table:
    from rich.table import Table
    from rich.text import Text

    made = Table(box=table.box, show_header=table.show_header)
    made.padding = table.padding
    for index in chosen:
        column = table.columns[index]
        whole = _longest(column)
        made.add_column(
            column.header, justify=column.justify, no_wrap=needed[index] == whole,
            min_width=needed[index], overflow="fold",
        )  # fmt: skip
    for row in zip(*(list(table.columns[index].cells) for index in chosen), strict=True):
        made.add_row(*(Text(cell) if isinstance(cell, str) else cell for cell in row))
    least = _frame(table, 0) + sum(needed[index] + _frame(table, 1) for index in chosen)
    made.width = least if least > width else None  # rich would leave out what has no room
    return made


def _narrowest(column: Column) -> int:
    """How narrow a column can be: numbers and names keep their width, texts that of a word."""
    return _longest(column, words=column.justify != "right" and not column.no_wrap)


def _longest(column: Column, *, words: bool = False) -> int:
    from rich.cells import cell_len

    texts = [column.header, *column.cells]
    parts = [
        part for text in texts for line in _plain(text).splitlines()
        for part in (line.split() if words else [line])
    ]  # fmt: skip
    return max(map(cell_len, parts), default=0)


def _plain(text: object) -> str:
    plain: Text | str | object = getattr(text, "plain", text)
    return str(plain)
