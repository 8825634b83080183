"""Comparing a trajectory with another: to the bit (`first_difference`), or with a reference (a
`Result` with a file) by a tube in time and value around the one that has more
rows, in which the rows of the other must lie.

At each row judged, at time t, the tube is taken over the window [t - w, t + w] with w = `time_band`
(s): the smallest and the largest value there (with interpolation at the ends of the window, both
sides of every jump, and steps held for what is discrete), widened by `relative` * (largest -
smallest of the whole reference, or its largest magnitude where it is constant) + `absolute`. So a
jump may come earlier or later by w, a smooth curve may differ by the value band, and what one of
the two does between the rows of the other is not judged: a reference sampled every 10 ms does not
know how fast a ball was when it hit the ground.

Strings and binaries must be equal to some value of the reference in the window. Rows beyond the
times of the other are not judged, and NaN is outside. A column agrees where all of its judged rows
are inside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError, nearest
from harness.results.columns import array_shapes
from harness.results.csv_files import ReferenceTable, read_reference
from harness.results.result import Result

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Band:
    """Half width in time (s), and in value relative to the reference's range and absolute."""

    time: float
    relative: float = 0.01
    absolute: float = 1e-12


@dataclass(frozen=True)
class Agreement:
    """How one column compares: `inside` of `judged` rows, the largest difference at
    equal times, and the time (s) of the first row outside the band, if any."""

    name: str
    judged: int
    inside: int
    largest: float
    first_outside: float | None

    @property
    def agrees(self) -> bool:
        """Whether there are rows to judge, and all are inside."""
        return 0 < self.judged == self.inside


def first_difference(labels: Sequence[str], expected: Array, found: Array) -> str | None:
    """The first difference of two runs of the same steps in words, None where they agree to the
    last bit. `labels` are the names of the columns, the rows (shape (n, columns)) the steps."""
    if expected.shape != found.shape:
        return f"{len(found)} steps until the FMU ends the run instead of {len(expected)}"
    unequal = expected.view(np.uint64) != found.view(np.uint64)
    if not unequal.any():
        return None
    row, column = map(int, np.argwhere(unequal)[0])
    return (
        f"{labels[column]} is {found[row, column]:.17g} instead of "
        f"{expected[row, column]:.17g} after step {row + 1}"
    )


def compare_with_file(
    result: Result, path: Path, time_band: float | None = None, value_band: float = 0.01
) -> tuple[tuple[Agreement, ...], Band]:
    """Compare `result` with the CSV file at `path`; the agreements and the band that was used.

    Where no `time_band` (s) is given it is the larger of the usual distances of the rows of both,
    since an event may be seen that much later.
    """
    reference = read_reference(path, array_shapes(result.names))
    if not reference.columns:
        raise UsageError(f"{path} has no column but the time")
    if time_band is None:
        time_band = max(_spacing(result.time), _spacing(reference.time))
    for what, width in (("time", time_band), ("value", value_band)):
        if not (np.isfinite(width) and width >= 0.0):
            raise UsageError(f"the {what} band must not be negative, not {width}")
    band = Band(time_band, value_band)
    return compare(result, reference, band), band


def _spacing(time: Array) -> float:
    gaps = np.diff(time)
    gaps = gaps[gaps > 0.0]
    return float(np.median(gaps)) if gaps.size else 0.0


def compare(result: Result, reference: ReferenceTable, band: Band) -> tuple[Agreement, ...]:
    """One `Agreement` for each column of the reference; raises `UsageError` where the result lacks
    one."""
    found = []
    for name in reference.columns:
        if name not in result:
            raise UsageError(
                f"{reference.path} has a column {name!r}, which was not recorded; "
                f"{nearest(name, result.names)}"
            )
        numbers = reference.numbers(name)
        if result.column(name).dtype is None or numbers is None:
            found.append(_texts(result, reference, name, band))
        else:
            found.append(_numbers(result, reference.time, numbers, name, band))
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


def _numbers(result: Result, time: Array, values: Array, name: str, band: Band) -> Agreement:
    held = not result.column(name).continuous
    spread = float(values.max() - values.min()) or float(np.abs(values).max())
    width = band.relative * spread + band.absolute
    ours = (result.time, result.numbers(name))
    dense, sparse = (ours, (time, values)) if len(ours[0]) > len(time) else ((time, values), ours)
    judged = _overlap(sparse[0], dense[0], band)
    at, own = sparse[0][judged], sparse[1][judged]
    low, high = tube(at, *dense, band.time, width, held)
    inside = (own >= low) & (own <= high)
    distance = np.abs(own - _at(at, *dense, held))
    return _agreement(name, at, inside, float(distance.max(initial=0.0)))


def _texts(result: Result, reference: ReferenceTable, name: str, band: Band) -> Agreement:
    judged = _overlap(result.time, reference.time, band)
    at, cells = result.time[judged], reference.columns[name]
    own = [str(one) for one in result[name][judged]]
    first = np.maximum(np.searchsorted(reference.time, at - band.time, "right") - 1, 0)
    last = np.maximum(np.searchsorted(reference.time, at + band.time, "right"), 1)
    windows = zip(own, first, last, strict=True)
    inside = np.array([text in cells[a:b] for text, a, b in windows], dtype=np.bool_)
    return _agreement(name, at, inside, 0.0 if inside.all() else float("nan"))


def _overlap(time: Array, reference: Array, band: Band) -> NDArray[np.bool_]:
    inside = (time >= reference[0] - band.time) & (time <= reference[-1] + band.time)
    return np.asarray(inside, dtype=np.bool_)


def _agreement(name: str, at: Array, inside: NDArray[np.bool_], largest: float) -> Agreement:
    outside = at[~inside]
    first = float(outside[0]) if len(outside) else None
    return Agreement(name, len(at), len(at) - len(outside), largest, first)
