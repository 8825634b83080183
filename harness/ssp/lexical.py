"""How values stand in XML attributes: the lexical forms of XML Schema that SSP uses."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

_DOUBLE = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?$")
_INTEGER = re.compile(r"[+-]?\d{1,40}$")
_SPECIAL = {"INF": math.inf, "+INF": math.inf, "-INF": -math.inf, "NaN": math.nan}
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


@dataclass(frozen=True)
class Form:
    """`read` makes a value of a text (ValueError says what it is not), `write` undoes it."""

    read: Callable[[str], Any]
    write: Callable[[Any], str]


def read_double(text: str) -> float:
    """An xs:double."""
    text = text.strip()
    if text in _SPECIAL:
        return _SPECIAL[text]
    if not _DOUBLE.match(text):
        raise ValueError("no number; write one, such as 1.5 or INF")
    return float(text)


def write_double(value: float) -> str:
    """The shortest text that reads back as the same double."""
    shown = repr(float(value))
    return {"nan": "NaN", "inf": "INF", "-inf": "-INF"}.get(shown, shown)


def read_integer(text: str) -> int:
    """An xs:integer."""
    if not _INTEGER.match(text.strip()):
        raise ValueError("no whole number; write one, such as 3")
    return int(text)


def read_boolean(text: str) -> bool:
    """An xs:boolean."""
    if text.strip() not in _BOOLEANS:
        raise ValueError("neither true nor false; write one of them")
    return _BOOLEANS[text.strip()]


def write_boolean(value: bool) -> str:
    """ "true" or "false"."""
    return "true" if value else "false"


FORMS: dict[type, Form] = {
    str: Form(str, str),
    float: Form(read_double, write_double),
    int: Form(read_integer, str),
    bool: Form(read_boolean, write_boolean),
    tuple: Form(lambda text: tuple(text.split()), " ".join),
}
"""The forms by type; a tuple is of tokens separated by white space."""
