"""`fmu-harness run`: run an experiment with all its variants; table, plots and rows in a folder;
and `resume`: go on with a run that was interrupted, from its last checkpoint."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from harness import registry
from harness.cli import options
from harness.cli.tables import show_table
from harness.cli.terminal import bars, echo, say
from harness.errors import HarnessError

if TYPE_CHECKING:
    from harness.cli.run_record import RunRecord


def run_command(
    experiment: options.ExperimentName,
    set_: options.Changes = None,
    variant: Annotated[
        list[str] | None, typer.Option(help="Run these variants only; repeatable")
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Run folder; runs/NAME-DATE-TIME when absent")
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace the run that the folder holds")
    ] = False,
    study: Annotated[bool, typer.Option(help="Repeat over the seeds of [study]")] = False,
    sweep: Annotated[bool, typer.Option(help="Run over the grid of [sweep]")] = False,
    jobs: options.Jobs = 0,
    fmi_logging: options.FmiLogging = False,
    call_timeout: options.CallTimeout = None,
    run_timeout: options.RunTimeout = None,
    memory_limit: options.MemoryLimit = None,
    isolate: options.Isolate = False,
    validate: options.Validate = True,
    compile_: options.Compile = False,
) -> None:
    """Run an experiment: every variant, then a table and PNG plots."""
    from harness.cli.run_record import RunRecord
    from harness.experiment.foresight import check_experiment
    from harness.results.atomic import check_writable

    limits = {"call": call_timeout, "run": run_timeout, "memory": memory_limit}
    pairs = options.for_fmus(set_, validate, compile_)
    changed = options.settings(pairs, {"limits": {**limits, "isolate": isolate or None}})
    with options.opened_experiment(experiment, changed) as loaded:
        kind = "study" if study else "sweep" if sweep else "run"
        part = loaded.spec.study if study else loaded.spec.sweep if sweep else None
        own = part.variants if part is not None else ()
        chosen = tuple(variant or own or loaded.variants)
        folder = output or registry.run_folder(loaded.name)
        check_writable(folder)
        check_experiment(loaded, chosen)
        record = RunRecord(loaded, chosen, changed, kind)
        record.write(folder, overwrite=overwrite)
        _finish(record, folder, jobs=jobs, logging=fmi_logging)


def resume_command(
    folder: Annotated[Path, typer.Argument(help="Run folder, as `run` named it")],
    jobs: options.Jobs = 0,
    fmi_logging: options.FmiLogging = False,
) -> None:
    """Go on with a run, study or sweep that ended early: what is complete is left as it is; a
    variant continues from its last checkpoint or begins, a study with the runs that it lacks."""
    from harness.cli.run_record import opened_run

    with opened_run(folder) as record:
        _finish(record, folder, jobs=jobs, logging=fmi_logging, resume=True)


def _finish(
    record: RunRecord, folder: Path, *, jobs: int, logging: bool, resume: bool = False
) -> None:
    """Run what the folder lacks, and report on all of it."""
    loaded = record.experiment
    say(f"{loaded.name}: {loaded.spec.title}", style="bold")
    if record.kind != "run":
        from harness.cli.repeat import repeat

        repeat(record, folder, jobs)
        return
    try:
        _run(record, folder, logging=logging, resume=resume)
    except KeyboardInterrupt as fault:
        raise HarnessError(
            f"{fault or 'interrupted by Ctrl-C'}; the rows so far are in {folder}, and "
            f"`fmu-harness resume {folder}` goes on with them"
        ) from None


def _run(record: RunRecord, folder: Path, *, logging: bool, resume: bool) -> None:
    from harness.experiment.report import metrics_table, signals_table, write_report
    from harness.experiment.variants import run_variants

    loaded = record.experiment
    with bars() as moved:
        ran = run_variants(
            loaded, record.variants, folder, lambda name, *told: moved(loaded.label(name), *told),
            echo=echo if logging else None, resume=resume,
        )  # fmt: skip
    results, faults = ran.results, ran.faults
    if len(record.variants) == 1 and not results:
        raise next(iter(faults.values()))
    for note in (note for result in results.values() for note in result.manifest.notes):
        warnings.warn(note, stacklevel=2)
    judged = loaded.spec.measure is not None or any(result.metrics for result in results.values())
    show_table(metrics_table(loaded, results) if judged else signals_table(loaded, results))
    for path in write_report(loaded, results, folder):
        say(f"written: {path}")
    if faults:
        raise HarnessError("\n".join(f"{loaded.label(n)}: {f}" for n, f in faults.items()))
