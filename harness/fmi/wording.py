"""Foreign text made fit for a sentence: on one line, without control characters, cut to length."""

from __future__ import annotations

import re

_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f]")


def shorten(text: str, limit: int = 80) -> str:
    """`text` on one line, without what would command a terminal, cut to `limit` characters."""
    flat = re.sub(r"\s*[\r\n\t]\s*", " ", text[: 4 * limit])
    if not flat.isprintable():
        flat = "".join(c if c.isprintable() else " " for c in flat)
    flat = flat.strip()
    return flat if len(flat) <= limit else flat[:limit] + "…"


def quoted(text: str, limit: int = 120) -> str:
    """`text` in quotes with control characters spelt out, cut to `limit` characters."""
    return repr(text if len(text) <= limit else text[:limit] + "…")


def has_control_characters(text: str) -> bool:
    """Whether `text` would break a line or command a terminal."""
    return _CONTROL.search(text) is not None
