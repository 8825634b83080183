"""Many runs of one experiment that differ in seed and settings, spread over processes."""

from __future__ import annotations

import copy
import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import chain, groupby
from pathlib import Path
from typing import Any

from harness.errors import HarnessError
from harness.experiment.experiment import Experiment
from harness.experiment.journal import Journal, Metrics, Point, Settings, note
from harness.experiment.merging import Table
from harness.experiment.parallel import Workers, given_or_one
from harness.experiment.schema import FmuSpec
from harness.process.watchdog import allow
from harness.results.result import Result

_CHUNKS = 4  # tasks of a variant that a worker gets, so that progress moves and the load evens out
_LONGEST = 25  # rows of a task, so that what is done of a study has pairs of all variants

Task = tuple[str, tuple[Point, ...]]
"""A variant and some of its points."""


def run_points(
    experiment: Experiment,
    variants: Sequence[str],
    rows: Sequence[Sequence[Point]],
    journal: Journal,
    *,
    workers: Workers | None,
    progress: Callable[[float], None] | None,
) -> None:
    """Every point of each variant into the `journal`, but for those that it has; None are the
    metrics of a run that ended early. Points of a row are run one after the other.

    `workers` None: one process of its own, as any run has; `Workers(1)` runs in this one. A run
    that kills its process is run again under a supervisor, and has ended early if it does so again.
    Where a fault or Ctrl-C passes through, the journal has what was done before.
    """
    found, n_points = journal.found, len(variants) * sum(map(len, rows))
    left = sum((v, point) not in found for v in variants for point in chain(*rows))
    with given_or_one(workers) as crew:
        tasks = _tasks(variants, rows, journal, crew.count)
        try:
            for (variant, some), metrics in crew.spread(
                partial(_run_prepared, experiment, journal.path),
                tasks,
                careful=partial(_run_isolated, experiment, journal.path),
            ):
                found |= {(variant, point): m for point, m in zip(some, metrics, strict=True)}
                left -= len(some)
                if progress is not None:
                    progress(1.0 - left / n_points)
        except BaseException:
            crew.abandon()
            journal.read()
            raise


def _tasks(
    variants: Sequence[str], rows: Sequence[Sequence[Point]], journal: Journal, workers: int
) -> list[Task]:
    """What is to do; the first is a single run, which builds and compiles for all."""
    stride = min(len(rows), max(workers * _CHUNKS, len(rows) // _LONGEST))
    tasks = [
        (
            variant,
            tuple(p for p in chain(*rows[start::stride]) if (variant, p) not in journal.found),
        )
        for start in range(stride)
        for variant in variants
    ]
    (variant, first), *others = [task for task in tasks if task[1]] or [("", ())]
    return [one for one in ((variant, first[:1]), (variant, first[1:]), *others) if one[1]]


def _run_prepared(experiment: Experiment, journal: Path | None, task: Task) -> list[Metrics | None]:
    """What only seeds and start values of FMUs tell apart is prepared once."""
    variant, points = task
    spec = experiment.variant_spec(variant)
    allow(spec.run_limits())

    def prepared_settings(point: Point) -> Settings:
        return tuple(one for one in point.settings if _variable(one[0], spec.components) is None)

    found = []
    for settings, some in groupby(points, prepared_settings):
        with _changed(experiment, variant, settings).prepare(variant) as prepared:
            for point in some:
                starts = _start_values(point, spec.components)
                found.append(_metrics(partial(prepared.run, seed=point.seed, start_values=starts)))
                note(journal, variant, point, found[-1])
    return found


def _run_isolated(experiment: Experiment, journal: Path | None, task: Task) -> list[Metrics | None]:
    """Every run in a worker of its own: one that dies loses its own point only."""
    variant, points = task
    found = []
    for point in points:
        run = partial(_changed(experiment, variant, point.settings).run, variant, seed=point.seed)
        found.append(_metrics(run, f"{experiment.label(variant)}, {point.name}"))
        note(journal, variant, point, found[-1])
    return found


def _metrics(run: Callable[[], Result], warn_of: str = "") -> Metrics | None:
    try:
        return dict(run().metrics)
    except HarnessError as fault:
        if fault.result is None:
            raise
        if warn_of:
            warnings.warn(f"{warn_of}: {fault}", stacklevel=2)
        return None


def _variable(key: str, components: Mapping[str, object]) -> tuple[str, str] | None:
    """The FMU and the variable of a key "components.FMU.start_values.VARIABLE"."""
    match key.split(".", 3):
        case ["components", name, "start_values", variable]:
            return (name, variable) if isinstance(components.get(name), FmuSpec) else None
    return None


def _start_values(point: Point, components: Mapping[str, object]) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = {}
    for key, value in point.settings:
        if (place := _variable(key, components)) is not None:
            found.setdefault(place[0], {})[place[1]] = value
    return found


def key_parts(key: str) -> list[str]:
    """The names of a key as TOML joins them: dots between, quotes about a name with dots."""
    return [quoted or plain for quoted, plain in re.findall(r'"([^"]*)"|([^."]+)', key)]


def setting(data: Table, key: str) -> Any:
    """What a file gives for a key, in which a number counts the elements of a list."""
    found: Any = data
    for part in key_parts(key):
        found = found[int(part)] if isinstance(found, list) else found[part]
    return found


def _changed(experiment: Experiment, variant: str, settings: Settings) -> Experiment:
    """The experiment with other settings of one variant."""
    if not settings:
        return experiment
    data = copy.deepcopy(experiment.data)
    own: Table = data["variants"][variant] if experiment.spec.variants else data
    for key, value in settings:
        _put(own, experiment.data, key_parts(key), value)
    return Experiment.from_data(data, experiment.path)


def _put(own: Any, whole: Any, parts: Sequence[str], value: float) -> None:
    """Set a key in the tables of a variant; a list, which a variant replaces, is first taken over
    from the `whole` file."""
    first, *others = parts
    place: Any = int(first) if isinstance(own, list) else first
    below = whole[place] if isinstance(whole, list) else (whole or {}).get(place)
    if not others:
        own[place] = value
        return
    if isinstance(own, dict) and place not in own:
        own[place] = copy.deepcopy(below) if isinstance(below, list) else {}
    _put(own[place], below, others, value)
