"""Warnings as notices of one line on the error stream, instead of Python's own form."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console


@contextmanager
def notices() -> Iterator[None]:
    """While open, each warning is printed once as "note: …"."""
    console = Console(stderr=True, highlight=False, soft_wrap=True)
    seen: set[str] = set()

    def show(message: Warning | str, *_: Any, **__: Any) -> None:
        text = str(message)
        if text not in seen:
            seen.add(text)
            console.print(f"note: {text}", markup=False)

    with warnings.catch_warnings():
        warnings.simplefilter("default")
        warnings.showwarning = show
        yield
