"""The console of all commands: as wide as the terminal, wide enough for a table elsewhere."""

from __future__ import annotations

from rich.console import Console

_WIDTH_ELSEWHERE = 132


def console(*, stderr: bool = False) -> Console:
    """A console without automatic highlighting; lines are not wrapped inside words."""
    found = Console(stderr=stderr, highlight=False)
    if found.is_terminal:
        return found
    return Console(stderr=stderr, highlight=False, width=_WIDTH_ELSEWHERE)
