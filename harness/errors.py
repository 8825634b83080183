"""Every fault that the harness reports: one tree, one sentence a fault.

The sentence says what happened, where (component, variable, file, time), what was expected and
what was received, and the legal choices or the way out.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any


class HarnessError(Exception):
    """Base of all faults reported by the harness.

    `result` holds the rows that a run recorded before the fault (a `Result`), or None where there
    was no run.
    """

    result: Any = None


class UsageError(HarnessError):
    """A command or call that cannot be meant: wrong name, wrong option, missing file."""


class ExperimentError(HarnessError):
    """An experiment file with a fault, named with file and key."""


class GraphError(HarnessError):
    """A system whose components and connections do not fit together."""


class UnitError(GraphError):
    """Two units that cannot be converted into each other."""


class TimingError(HarnessError):
    """Rates, delays or times that do not fit the integer time grid."""


class FmuError(HarnessError):
    """An FMU that cannot be read, loaded or driven."""


class SimulationError(HarnessError):
    """A run that ended before its stop time; the rows recorded so far are kept."""


class EndRequestedError(SimulationError):
    """An FMU asked for the end of the run before its stop time; no call failed."""


class RecordingError(HarnessError):
    """A recording that cannot be written or read."""


@contextmanager
def at(place: str) -> Iterator[None]:
    """Faults inside become an `ExperimentError` that begins by `place`."""
    try:
        yield
    except HarnessError as fault:
        raise ExperimentError(f"{place}: {fault}") from fault


def nearest(name: str, legal: Iterable[str], *, limit: int = 3) -> str:
    """The legal names nearest to `name` as a phrase for an error, or all of them when few."""
    names = sorted(set(legal))
    close = difflib.get_close_matches(name, names, n=limit, cutoff=0.5)
    if close:
        return "did you mean " + " or ".join(repr(one) for one in close) + "?"
    if not names:
        return "there are none to choose from"
    shown = ", ".join(names[:12]) + (f" … ({len(names)} in all)" if len(names) > 12 else "")
    return f"legal names: {shown}"
