"""Numbers and truth values as XML writes them; None where a text is none."""

from __future__ import annotations

from typing import Any


def real(text: Any) -> float | None:
    """A number, also NaN and infinity."""
    try:
        return None if text is None or "_" in text else float(text)
    except ValueError:
        return None


def integer(text: Any) -> int | None:
    """An integer of up to 64 bits."""
    try:
        value = None if text is None or "_" in text else int(text)
    except ValueError:
        return None
    return value if value is not None and -(2**63) <= value < 2**64 else None


def boolean(text: Any) -> bool:
    """Whether a Boolean attribute is set."""
    return text is not None and text.strip() in ("true", "1")
