"""A static fault of an FMU, with its severity."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import partial

PLACE = "modelDescription.xml"
_SHOWN = 5


class Severity(StrEnum):
    """How much a problem matters."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True)
class Problem:
    """One problem: where it is, what it is, and the sentence of the standard that it breaks."""

    severity: Severity
    place: str
    text: str
    rule: str = ""


error = partial(Problem, Severity.ERROR)
warning = partial(Problem, Severity.WARNING)
note = partial(Problem, Severity.NOTE)


def listed(names: list[str]) -> str:
    """The first few names, and how many more there are."""
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more
