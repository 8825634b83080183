"""`fmu-harness run`: run an experiment with all its variants; table, plots and rows in a folder;
and `resume`: go on with a run that was interrupted, from its last checkpoint."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from harness import registry
from harness.cli import options
from harness.cli.terminal import bar, console, echo, say
from harness.errors import HarnessError

if TYPE_CHECKING:
    from harness.cli.run_record import RunRecord
    from harness.experiment.experiment import Experiment


def run_command(
    experiment: options.ExperimentName,
    set_: options.Changes = None,
    variant: Annotated[
        list[str] | None, typer.Option(help="Run these variants only; repeatable")
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Run folder; runs/NAME-DATE-TIME when absent")
    ] = None,
    study: Annotated[bool, typer.Option(help="Repeat over the seeds of [study]")] = False,
    sweep: Annotated[bool, typer.Option(help="Run over the grid of [sweep]")] = False,
    jobs: Annotated[int, typer.Option(help="Processes of a study or sweep; 0: all cores")] = 0,
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

    limits = {"call": call_timeout, "run": run_timeout, "memory": memory_limit}
    pairs = options.for_fmus(set_, validate, compile_)
    changed = options.settings(pairs, {"limits": {**limits, "isolate": isolate or None}})
    with options.opened_experiment(experiment, changed) as loaded:
        chosen = tuple(variant or loaded.variants)
        for name in chosen:
            loaded.variant_spec(name)
        folder = output or registry.run_folder(loaded.name)
        if study or sweep:
            _announce(loaded)
            _repeat(loaded, tuple(variant or ()), folder, jobs, study=study)
        else:
            record = RunRecord(loaded, chosen, changed)
            record.write(folder)
            _finish(record, folder, logging=fmi_logging)


def resume_command(
    folder: Annotated[Path, typer.Argument(help="Run folder, as `run` named it")],
    fmi_logging: options.FmiLogging = False,
) -> None:
    """Go on with an interrupted run: variants that are complete are kept, others continue from
    their last checkpoint or begin."""
    from harness.cli.run_record import opened_run

    with opened_run(folder) as record:
        _finish(record, folder, logging=fmi_logging, resume=True)


def _finish(record: RunRecord, folder: Path, *, logging: bool, resume: bool = False) -> None:
    """Run what the folder lacks, and report on all of it."""
    _announce(record.experiment)
    try:
        _run(record, folder, logging=logging, resume=resume)
    except KeyboardInterrupt as fault:
        raise HarnessError(
            f"{fault or 'interrupted by Ctrl-C'}; the rows so far are in {folder}, and "
            f"`fmu-harness resume {folder}` goes on with them"
        ) from None


def _announce(loaded: Experiment) -> None:
    say(f"{loaded.name}: {loaded.spec.title}", style="bold")


def _run(record: RunRecord, folder: Path, *, logging: bool, resume: bool) -> None:
    from harness.experiment.report import metrics_table, signals_table, write_report

    loaded = record.experiment
    results, faults = {}, {}
    for name in record.variants:
        try:
            with bar(loaded.label(name)) as moved:
                results[name] = loaded.run(
                    name, folder / name, progress=moved, echo=echo if logging else None,
                    resume=resume,
                )  # fmt: skip
        except HarnessError as fault:
            if fault.result is None:
                raise
            faults[name], results[name] = fault, fault.result
    for note in (note for result in results.values() for note in result.manifest.notes):
        warnings.warn(note, stacklevel=2)
    judged = loaded.spec.measure is not None or any(result.metrics for result in results.values())
    console().print(metrics_table(loaded, results) if judged else signals_table(loaded, results))
    for path in write_report(loaded, results, folder):
        say(f"written: {path}")
    if faults:
        raise HarnessError("\n".join(f"{loaded.label(n)}: {f}" for n, f in faults.items()))


def _repeat(
    loaded: Experiment, variants: tuple[str, ...], folder: Path, jobs: int, *, study: bool
) -> None:
    """The study or the sweep of some variants, of those that the file names where none are."""
    from harness.experiment.parallel import Workers
    from harness.experiment.study import run_study, study_tables
    from harness.experiment.sweep import run_sweep, write_sweep
    from harness.results.atomic import check_free

    check_free(folder, "study.csv" if study else "regions.csv")
    with bar("study" if study else "sweep") as moved, Workers(jobs, isolated=True) as workers:
        if study:
            found = run_study(loaded, variants, workers=workers, progress=moved)
        else:
            regions = run_sweep(loaded, variants, workers=workers, progress=moved)
    if study:
        console().print(*study_tables(loaded, found), sep="\n")
        written = [found.write(folder)]
    else:
        for name, region in regions.items():
            say(f"{loaded.label(name)}: {100 * region.share:.1f} % of the points inside")
            if region.least is not None:
                x, y, outcome = region.least
                where = f"{region.spec.x.key} = {x:.6g}, {region.spec.y.key} = {y:.6g}"
                say(f"  least {region.spec.outcome}: {outcome:.4g} at {where}")
        written = write_sweep(loaded, regions, folder)
    for path in written:
        say(f"written: {path}")
