"""Faults of an FMU's documents, graded by what they may do to a value.

What cannot change a value is told, and the run goes on. What leaves open which value is meant is
refused, unless the caller passes `validate=False`. What can harm the machine, or cannot be read,
is refused all the same. A fault is a phrase about the document, such as "has 'T' with min 2 above
max 0", with its line and the sentence of the standard that it breaks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

from harness.errors import FmuError
from harness.fmi.wording import shorten

DOCUMENT = "modelDescription.xml"
WAY_OUT = "--no-validate (validate=False) reads it all the same"
ANEW = "mend the document, or have the FMU exported anew"
"""The way out where nothing lets a fault pass."""
_SHOWN = 3


class Harm(IntEnum):
    """What a fault may do."""

    NONE = 0
    """No value changes by it."""
    AMBIGUOUS = 1
    """Which value is meant stays open."""
    FORBIDDEN = 2
    """It could do harm, or what it is about cannot be read."""


@dataclass(frozen=True)
class Fault:
    """A phrase about the document, the line (0 where it has none) and the sentence it breaks."""

    harm: Harm
    text: str
    line: int = 0
    rule: str = ""

    def __str__(self) -> str:
        return self.text + (f" (line {self.line})" if self.line else "")


def quoted(name: str) -> str:
    """A name of the document in quotes, fit for a sentence."""
    return repr(shorten(name))


def notes(faults: Sequence[Fault], source: Path, validate: bool = True) -> tuple[str, ...]:
    """Sentences about the faults that are let pass; `source` is the archive.

    Raises `FmuError` where one of them is not.
    """
    harmless = [str(f) for f in faults if f.harm is Harm.NONE]
    grave = [str(f) for f in faults if f.harm is not Harm.NONE]
    forbidden = [f for f in faults if f.harm is Harm.FORBIDDEN]
    if grave and (validate or forbidden):
        raise FmuError(f"{_sentence(grave, source)}; {ANEW if forbidden else WAY_OUT}")
    return tuple(_sentence(texts, source) for texts in (grave, harmless) if texts)


def _sentence(texts: Sequence[str], source: Path) -> str:
    shown = "; ".join(dict.fromkeys(texts[:_SHOWN]))
    more = f" (and {len(texts) - _SHOWN} more)" if len(texts) > _SHOWN else ""
    return f"{DOCUMENT} of {source} {shown}{more}"
