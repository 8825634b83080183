"""The variants of an experiment, each run once: side by side where there are cores, since a run
uses one, and with what they say in the order of the variants."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Protocol

from harness.compiler.machine_code import announcing
from harness.errors import HarnessError
from harness.experiment.experiment import Experiment
from harness.master.prepared import Echo
from harness.process.side_by_side import Ended, Tell, at_once, side_by_side
from harness.process.warm import load_for_runs
from harness.results.result import Result


class Moved(Protocol):
    """Told how far a variant is, as a share, or what is compiled for it."""

    def __call__(self, variant: str, share: float | None, compiling: str = "") -> None:
        """Show it; a share of None: it stays what it was."""


@dataclass(frozen=True)
class Ran:
    """The results of the variants that have rows, and the faults of those that ended early."""

    results: Mapping[str, Result] = field(default_factory=dict)
    faults: Mapping[str, HarnessError] = field(default_factory=dict)


def run_variants(
    experiment: Experiment,
    variants: Sequence[str],
    folder: Path,
    moved: Moved,
    *,
    echo: Echo | None = None,
    resume: bool = False,
) -> Ran:
    """Run `variants` into folders of their names in `folder`; one after the other where messages
    are echoed. Raises what is no `HarnessError`."""
    one = _Variant(experiment, folder, echo, resume)
    if echo is not None or at_once(len(variants)) < 2:
        ended = (_here(partial(one.run, name), partial(moved, name)) for name in variants)
    else:
        load_for_runs()
        with suppress(HarnessError):  # what the first one loads and builds is there for all
            experiment.bench(variants[0])
        works = [partial(one.to_folder, name) for name in variants]
        apart = side_by_side(works, lambda number, *told: moved(variants[number], *told))
        ended = (one.found(name, end) for name, end in zip(variants, apart, strict=True))
    results, faults = {}, {}
    for name, end in zip(variants, ended, strict=True):
        result = end.value
        if isinstance(end.fault, HarnessError):
            faults[name], result = end.fault, end.fault.result
        elif end.fault is not None:
            raise end.fault
        if result is not None:
            results[name] = result
    return Ran(results, faults)


def _here(work: Callable[[Tell], Result], tell: Tell) -> Ended:
    try:
        return Ended(work(tell))
    except HarnessError as fault:
        return Ended(fault=fault)


@dataclass(frozen=True)
class _Variant:
    """How any of the variants is run."""

    experiment: Experiment
    folder: Path
    echo: Echo | None
    resume: bool

    def run(self, name: str, tell: Tell) -> Result:
        """Run it, and tell the share that is done."""
        with announcing(lambda what: tell(None, what)):
            return self.experiment.run(
                name, self.folder / name, progress=tell, echo=self.echo, resume=self.resume
            )

    def to_folder(self, name: str, tell: Tell) -> bool:
        """Run it in a process of its own: the result stays in the folder. A fault is raised;
        its result, for which there is True, is there, too."""
        try:
            self.run(name, tell)
        except BaseException as fault:
            if getattr(fault, "result", None) is not None:
                fault.result = True  # type: ignore[attr-defined]
            raise
        return True

    def found(self, name: str, end: Ended) -> Ended:
        """What such a process has left."""
        if end.fault is None:
            return Ended(self.experiment.recorded(name, self.folder / name))
        if isinstance(end.fault, HarnessError) and end.fault.result:
            end.fault.result = self.experiment.recorded(name, self.folder / name)
        return end
