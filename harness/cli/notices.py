"""Warnings as notices of one line on the error stream, instead of Python's own form."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from harness.cli.terminal import say


@contextmanager
def notices() -> Iterator[None]:
    """While open, each warning is printed once as "note: …"."""
    seen: set[str] = set()

    def show(message: Warning | str, *_: Any, **__: Any) -> None:
        text = str(message)
        if text not in seen:
            seen.add(text)
            say(f"note: {text}", stderr=True)

    with warnings.catch_warnings():
        warnings.simplefilter("default")
        warnings.showwarning = show
        yield
