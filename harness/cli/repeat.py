"""A study or a sweep on the command line: its folder, its tables, and what stays of it when it ends
early."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.cli.tables import show_table
from harness.cli.terminal import bar, say
from harness.errors import HarnessError

if TYPE_CHECKING:
    from harness.cli.run_record import RunRecord


def repeat(record: RunRecord, folder: Path, jobs: int) -> None:
    """The study or the sweep of some variants, into `folder`; what it has is not run again.

    Where it ends early, what was done is shown and stays, and `resume` goes on with it.
    """
    from harness.experiment.journal import JOURNAL_FILE, Journal
    from harness.experiment.parallel import Workers
    from harness.experiment.study import run_study
    from harness.experiment.sweep import run_sweep
    from harness.results.manifest import COMPLETE, INCOMPLETE, RunStatus

    journal, loaded = Journal(folder / JOURNAL_FILE), record.experiment
    journal.read()
    manifest = record.manifest(folder)
    manifest.write(folder)
    early: KeyboardInterrupt | HarnessError | None = None
    run: Callable[..., Any] = run_study if record.kind == "study" else run_sweep
    try:
        with bar(record.kind) as moved, Workers(jobs, isolated=True) as workers:
            found = run(loaded, record.variants, workers=workers, progress=moved, journal=journal)
    except (KeyboardInterrupt, HarnessError) as fault:
        early, found = fault, getattr(fault, "result", None)
    if found is not None and journal.found:
        _show(record, found, folder)
    said = "" if early is None else str(early) or "interrupted by Ctrl-C"
    status = RunStatus(COMPLETE if early is None else INCOMPLETE, None, said)
    replace(manifest, status=status).write(folder)
    if early is not None:
        how = f"{len(journal.found)} runs are done and stay in {folder}"
        raise HarnessError(
            f"{said}; {how}, and `fmu-harness resume {folder}` goes on with them"
        ) from (early if isinstance(early, HarnessError) else None)


def _show(record: RunRecord, found: Any, folder: Path) -> None:
    """Tables of what is done, and the files of it."""
    from harness.experiment.study import study_tables
    from harness.experiment.sweep import write_sweep

    loaded = record.experiment
    if record.kind == "study":
        show_table(*study_tables(loaded, found))
        written = [found.write(folder)]
    else:
        for name, region in found.items():
            share = f"{100 * region.share:.1f} %" if region.done.any() else "none"
            part = "" if region.done.all() else f" ({region.done.sum()} of {region.done.size} done)"
            say(f"{loaded.label(name)}: {share} of the points inside{part}")
            if region.least is not None:
                x, y, outcome = region.least
                where = f"{region.spec.x.key} = {x:.6g}, {region.spec.y.key} = {y:.6g}"
                say(f"  least {region.spec.outcome}: {outcome:.4g} at {where}")
        written = write_sweep(loaded, found, folder)
    for path in written:
        say(f"written: {path}")
