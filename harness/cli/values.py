"""Settings on the command line: `key=value`, both as in TOML, the value else as a string."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Sequence
from typing import Any

from harness.errors import UsageError


def settings(pairs: Sequence[str]) -> dict[str, Any]:
    """The tables that `pairs` stand for, as in `seed=7`, `components.plant.step=0.005`,
    `connections."plant.command".delay=0.01`; raises `UsageError` for what is none."""
    found: dict[str, Any] = {}
    for pair in pairs:
        key, equals, text = pair.partition("=")
        if not equals or not key.strip():
            raise UsageError(f"--set {pair!r} must have the form key=value, as in --set seed=7")
        _into(found, _parse(pair, key, text))
    return found


def _parse(pair: str, key: str, text: str) -> dict[str, Any]:
    for value in (text, json.dumps(text)):
        try:
            return tomllib.loads(f"{key} = {value}")
        except tomllib.TOMLDecodeError:
            continue
    raise UsageError(
        f"--set {pair!r}: {key!r} is no key; join names by dots, quote those with dots"
    )


def _into(found: dict[str, Any], given: dict[str, Any]) -> None:
    for key, value in given.items():
        if isinstance(value, dict) and isinstance(found.get(key), dict):
            _into(found[key], value)
        else:
            found[key] = value
