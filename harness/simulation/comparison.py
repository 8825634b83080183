"""Comparing a trajectory with a reference: a tube in time and value around the one that has more
rows, in which the rows of the other must lie.

At each row judged, at time t, the tube is taken over the window [t - w, t + w] with w = `time_band`
(s): the smallest and the largest value there (with interpolation at the ends of the window, both
sides of every jump, and steps held for what is discrete), widened by `relative` * (largest -
smallest of the whole reference, or its largest magnitude where it is constant) + `absolute`. So a
jump may come earlier or later by w, a smooth curve may differ by the value band, and what one of
the two does between the rows of the other is not judged: a reference sampled every 10 ms does not
know how fast a ball was when it hit the ground.

Strings and binaries must be equal to some value of the reference in the window. Rows beyond the
times of the other are not judged. A column agrees where at least `share` of its judged rows are
inside; by default all of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError, nearest
from harness.results.result import Result
from harness.simulation.csv_files import ReferenceTable

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
    """How one column compares: `inside` of `judged` rows, the largest difference at
    equal times, and the time (s) of the first row outside the band, if any."""

    name: str
    judged: int
    inside: int
    largest: float
    first_outside: float | None
    agrees: bool


def compare(
    result: Result, reference: ReferenceTable, band: Band, discrete: Mapping[str, bool]
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
    at: Array, time: Array, values: Array, band: float, width: float, held: bool
) -> tuple[Array, Array]:
    """The lower and upper edge, at the times `at`, of the tube around the trajectory (`time`,
    `values`); `band` in s, `width` in the unit of the values. Shapes (n,)."""
    first = np.searchsorted(time, at - band, "left")
    last = np.searchsorted(time, at + band, "right")
    low, high = np.empty(len(at)), np.empty(len(at))
    ends = [_at(t, time, values, held) for t in (at - band, at + band)]
    for i in range(len(at)):
        window = values[first[i] : last[i]]
        edges = (ends[0][i], ends[1][i])
        low[i] = min(*edges, window.min()) if window.size else min(edges)
        high[i] = max(*edges, window.max()) if window.size else max(edges)
    return low - width, high + width


def _at(at: Array, time: Array, values: Array, held: bool) -> Array:
    if held:
        index = np.searchsorted(time, at, "right") - 1
        return np.asarray(values[np.clip(index, 0, len(values) - 1)])
    return np.asarray(np.interp(at, time, values))


def _numbers(
    result: Result, time: Array, values: Array, name: str, band: Band, held: bool
) -> Agreement:
    spread = float(values.max() - values.min()) or float(np.abs(values).max())
    width = band.relative * spread + band.absolute
    ours = (result.time, np.asarray(result[name], dtype=np.float64))
    dense, sparse = (ours, (time, values)) if len(ours[0]) > len(time) else ((time, values), ours)
    judged = _overlap(sparse[0], dense[0], band)
    at, own = sparse[0][judged], sparse[1][judged]
    low, high = tube(at, *dense, band.time, width, held)
    inside = (own >= low) & (own <= high)
    distance = np.abs(own - _at(at, *dense, held))
    return _agreement(name, at, inside, float(distance.max(initial=0.0)), band)


def _texts(result: Result, reference: ReferenceTable, name: str, band: Band) -> Agreement:
    judged = _overlap(result.time, reference.time, band)
    at, cells = result.time[judged], reference.columns[name]
    own = [str(one) for one in result[name][judged]]
    inside = np.zeros(len(at), dtype=np.bool_)
    for i, text in enumerate(own):
        first = int(np.searchsorted(reference.time, at[i] - band.time, "right"))
        last = int(np.searchsorted(reference.time, at[i] + band.time, "right"))
        inside[i] = text in cells[max(first - 1, 0) : max(last, 1)]
    return _agreement(name, at, inside, 0.0 if inside.all() else float("nan"), band)


def _overlap(time: Array, reference: Array, band: Band) -> NDArray[np.bool_]:
    inside = (time >= reference[0] - band.time) & (time <= reference[-1] + band.time)
    return np.asarray(inside, dtype=np.bool_)


def _agreement(
    name: str, at: Array, inside: NDArray[np.bool_], largest: float, band: Band
) -> Agreement:
    count, total = int(np.count_nonzero(inside)), len(at)
    first = None if count == total else float(at[int(np.argmin(inside))])
    agrees = total > 0 and count >= band.share * total
    return Agreement(name, total, count, largest, first, agrees)
