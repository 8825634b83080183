"""Settings on the command line: `key=value`, the value read as TOML, else as a string."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from typing import Any

from harness.errors import UsageError


def settings(pairs: Sequence[str]) -> dict[str, Any]:
    """Dotted keys and their values; raises `UsageError` where there is no "="."""
    found = {}
    for pair in pairs:
        key, equals, text = pair.partition("=")
        if not equals or not key.strip():
            raise UsageError(f"--set {pair!r} must have the form key=value, as in --set seed=7")
        try:
            found[key.strip()] = tomllib.loads(f"value = {text}")["value"]
        except tomllib.TOMLDecodeError:
            found[key.strip()] = text
    return found
