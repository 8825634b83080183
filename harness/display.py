"""What a notebook shows: small tables as HTML, and a bar while a run lasts.

Text of users and FMUs is escaped. Nothing of IPython is imported where it does not run already.
"""

from __future__ import annotations

import html
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

_SECONDS = 0.2  # between two looks of the bar


def html_table(
    title: str, headings: Sequence[str], rows: Iterable[Sequence[object]], *, most: int = 40
) -> str:
    """Rows under headings as HTML, at most so many, with a line that says how many there are."""
    every = [[html.escape(str(cell)) for cell in row] for row in rows]
    lines = [f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in every[:most]]
    head = "".join(f"<th>{html.escape(one)}</th>" for one in headings)
    more = f"<p>… {len(every) - most} more</p>" if len(every) > most else ""
    return (
        f"<p><b>{html.escape(title)}</b></p><table><thead><tr>{head}</tr></thead>"
        f"<tbody>{''.join(lines)}</tbody></table>{more}"
    )


def in_notebook() -> bool:
    """Whether this process serves a notebook."""
    ipython: Any = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return shell is not None and hasattr(shell, "kernel")


@contextmanager
def progress_in_notebook(name: str) -> Iterator[Callable[[float], None] | None]:
    """A bar below the cell that is told the share that is done, and goes when all is done; None
    where there is no notebook."""
    if not in_notebook():
        yield None
        return
    display: Any = sys.modules["IPython"].display
    handle, last = display.display(display.HTML(""), display_id=True), 0.0

    def moved(share: float) -> None:
        nonlocal last
        if time.monotonic() - last > _SECONDS:
            last = time.monotonic()
            bar = f"<progress value='{share:.4f}' max='1'></progress> {share:.0%}"
            handle.update(display.HTML(f"{html.escape(name)} {bar}"))

    try:
        yield moved
    finally:
        handle.update(display.HTML(""))
