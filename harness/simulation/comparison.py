"""Comparing a trajectory with a reference: a tube around the reference in time and value.

At each row of the result, at time t, the reference is taken over the window [t - w, t + w], with
w = `time_band` (s); its smallest and largest value there (with linear interpolation at the ends of
the window, both sides of every jump, and steps held for what is discrete) are widened by
`value_band` = `relative` * (largest - smallest of the whole reference, or its largest magnitude
where it is constant) + `absolute`. The row is inside where its value lies between them. So a jump
may come earlier or later by w, and a smooth curve may differ by the value band.

Strings and binaries must be equal to some value of the reference in the window. Rows beyond the
reference's times are not judged. A column agrees where at least `share` of its judged rows are
inside; by default all of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError, nearest
from harness.simulation.csv_files import ReferenceTable
from harness.simulation.outputs import SimulationResult

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Band:
    """Half width in time (s), and in value relative to the reference's range and absolute."""

    time: float
    relative: float = 0.01
    absolute: float = 1e-12
    share: float = 1.0


@dataclass(frozen=True)
class Agreement:
    """How one column compares: `inside` of `judged` rows, the largest distance from the reference
    itself at equal times, and the time (s) of the first row outside the band, if any."""

    name: str
    judged: int
    inside: int
    largest: float
    first_outside: float | None
    agrees: bool


def compare(
    result: SimulationResult, reference: ReferenceTable, band: Band, discrete: Mapping[str, bool]
) -> tuple[Agreement, ...]:
    """One `Agreement` for each column of the reference; raises `UsageError` where the result lacks
    one. `discrete` says which columns are held between rows instead of interpolated."""
    found = []
    for name in reference.columns:
        if name not in result:
            raise UsageError(
                f"{reference.path} has a column {name!r}, which was not recorded; "
                f"{nearest(name, result.order)}"
            )
        numbers = reference.numbers(name)
        if name in result.texts or numbers is None:
            found.append(_texts(result, reference, name, band))
        else:
            held = discrete.get(name, False)
            found.append(_numbers(result, reference.time, numbers, name, band, held))
    return tuple(found)


def tube(
    time: Array, reference_time: Array, values: Array, band: Band, held: bool
) -> tuple[Array, Array]:
    """The lower and upper edge of the tube at `time`, shapes (n,)."""
    spread = float(values.max() - values.min()) or float(np.abs(values).max())
    width = band.relative * spread + band.absolute
    first = np.searchsorted(reference_time, time - band.time, "left")
    last = np.searchsorted(reference_time, time + band.time, "right")
    low, high = np.empty(len(time)), np.empty(len(time))
    ends = [_at(t, reference_time, values, held) for t in (time - band.time, time + band.time)]
    for i in range(len(time)):
        window = values[first[i] : last[i]]
        edges = (ends[0][i], ends[1][i])
        low[i] = min(*edges, window.min()) if window.size else min(edges)
        high[i] = max(*edges, window.max()) if window.size else max(edges)
    return low - width, high + width


def _at(time: Array, reference_time: Array, values: Array, held: bool) -> Array:
    if held:
        index = np.searchsorted(reference_time, time, "right") - 1
        return np.asarray(values[np.clip(index, 0, len(values) - 1)])
    return np.asarray(np.interp(time, reference_time, values))


def _numbers(
    result: SimulationResult, time: Array, values: Array, name: str, band: Band, held: bool
) -> Agreement:
    judged = _overlap(result.time, time, band)
    at, own = result.time[judged], np.asarray(result[name], dtype=np.float64)[judged]
    low, high = tube(at, time, values, band, held)
    inside = (own >= low) & (own <= high)
    middle = _at(at, time, values, held)
    largest = float(np.max(np.abs(own - middle))) if len(own) else 0.0
    return _agreement(name, at, inside, largest, band)


def _texts(
    result: SimulationResult, reference: ReferenceTable, name: str, band: Band
) -> Agreement:
    judged = _overlap(result.time, reference.time, band)
    at, cells = result.time[judged], reference.columns[name]
    own = [str(one) for one in result[name][judged]]
    inside = np.zeros(len(at), dtype=np.bool_)
    for i, text in enumerate(own):
        first = int(np.searchsorted(reference.time, at[i] - band.time, "left"))
        last = int(np.searchsorted(reference.time, at[i] + band.time, "right"))
        inside[i] = text in cells[max(first - 1, 0) : max(last, 1)]
    return _agreement(name, at, inside, 0.0 if inside.all() else float("nan"), band)


def _overlap(time: Array, reference: Array, band: Band) -> NDArray[np.bool_]:
    return (time >= reference[0] - band.time) & (time <= reference[-1] + band.time)


def _agreement(
    name: str, at: Array, inside: NDArray[np.bool_], largest: float, band: Band
) -> Agreement:
    count, total = int(np.count_nonzero(inside)), len(at)
    first = None if count == total else float(at[int(np.argmin(inside))])
    agrees = total > 0 and count >= band.share * total
    return Agreement(name, total, count, largest, first, agrees)
