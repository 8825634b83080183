"""What all commands print with: a console as wide as the terminal, wide enough for a table
elsewhere, lines, tables and bars in which no text is taken for markup."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from rich.box import Box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

_WIDTH_ELSEWHERE = 132


def console(*, stderr: bool = False) -> Console:
    """A console without automatic highlighting; lines are not wrapped inside words."""
    from rich.console import Console

    found = Console(stderr=stderr, highlight=False)
    if found.is_terminal:
        return found
    return Console(stderr=stderr, highlight=False, width=_WIDTH_ELSEWHERE)


def say(text: object, *, stderr: bool = False, style: str | None = None) -> None:
    """Print a line, which only the terminal wraps."""
    console(stderr=stderr).print(str(text), markup=False, soft_wrap=True, style=style)


def note(text: object) -> None:
    """Print a note on the error stream."""
    say(f"note: {text}", stderr=True)


def echo(*message: object) -> None:
    """Print a message of an FMU, or of a component and its FMU, on the error stream."""
    print(*message, file=sys.stderr)


def say_json(data: Any) -> None:
    """Print plain data as JSON."""
    print(json.dumps(data, indent=2, ensure_ascii=False))


def table(
    headings: Sequence[str],
    rows: Iterable[Sequence[str | Text]],
    *,
    title: str = "",
    right: Collection[str] = (),
    box: Box | None = None,
) -> Table:
    """Rows under headings; the columns `right` are justified to the right."""
    from rich.table import Table
    from rich.text import Text

    made = Table(title=Text(title) if title else None, title_justify="left", box=box)
    made.padding = (0, 2) if box is None else (0, 1)
    for heading in headings:
        made.add_column(heading, justify="right" if heading in right else "left")
    for row in rows:
        made.add_row(*(Text(cell) if isinstance(cell, str) else cell for cell in row))
    return made


def properties(title: str, rows: Iterable[tuple[str, str]]) -> Table:
    """Names in bold, each with what there is to say of it."""
    from rich.text import Text

    made = table(("", ""), ((Text(name, style="bold"), text) for name, text in rows), title=title)
    made.show_header, made.columns[0].no_wrap = False, True
    return made


class Moved(Protocol):
    """Told how far a task is, as a share, and what it is at."""

    def __call__(self, share: float, at: str = ...) -> None:
        """Show it."""


@contextmanager
def bar(name: str) -> Iterator[Moved]:
    """While open, the error stream shows the progress of a task: name, bar, share, time gone and
    time left."""
    from harness.compiler.machine_code import announcing

    with bars() as moved, announcing(lambda what: moved(name, None, what)):
        moved(name, 0.0)
        yield lambda share, at=name: moved(name, share, at=at)


@contextmanager
def bars() -> Iterator[Callable[..., None]]:
    """The same for several tasks, by name: they are shown from the moment at which they have
    moved to a share, or something is compiled for them."""
    from rich import progress as p

    text, share = p.TextColumn("{task.description}", markup=False), "{task.percentage:3.0f} %"
    times = p.TimeElapsedColumn(), p.TimeRemainingColumn()
    columns = text, p.BarColumn(), p.TextColumn(share), *times
    with p.Progress(*columns, console=console(stderr=True)) as shown:
        tasks: dict[str, p.TaskID] = {}

        def moved(name: str, share: float | None, compiling: str = "", at: str = "") -> None:
            if name not in tasks:
                tasks[name] = shown.add_task(name, total=1.0)
            if compiling:
                at = f"{name}: compiling {compiling}, once on this machine"
            shown.update(tasks[name], description=at or name, completed=share)

        yield moved
