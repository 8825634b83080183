"""The sentences of the standard that descriptions break; `rules.toml` has them by key."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path


def rule(key: str, fmi_major: int) -> str:
    """The sentence as a citation, "" where that version of FMI has none."""
    text = _rules()[key].get(str(fmi_major), "")
    return f"FMI {fmi_major}.0, {text}" if text else ""


@cache
def _rules() -> dict[str, dict[str, str]]:
    return tomllib.loads(Path(__file__).with_name("rules.toml").read_text(encoding="utf-8"))
