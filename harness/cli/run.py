"""`fmu-harness run`: run an experiment with all its variants; table, plots and rows in a folder."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.progress import Progress

from harness import registry
from harness.cli.experiments import Changes, ExperimentName, opened_experiment
from harness.cli.limits import CallTimeout, Isolate, MemoryLimit, RunTimeout
from harness.cli.notices import notices
from harness.cli.progress import bar
from harness.cli.terminal import console, say
from harness.cli.values import settings
from harness.errors import HarnessError

if TYPE_CHECKING:
    from harness.bench import Echo
    from harness.cli.run_record import RunRecord
    from harness.experiment.experiment import Experiment


def run_command(
    experiment: ExperimentName,
    set_: Changes = None,
    variant: Annotated[
        list[str] | None, typer.Option(help="Run these variants only; repeatable")
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Run folder; runs/NAME-DATE-TIME when absent")
    ] = None,
    study: Annotated[bool, typer.Option(help="Repeat over the seeds of [study]")] = False,
    sweep: Annotated[bool, typer.Option(help="Run over the grid of [sweep]")] = False,
    jobs: Annotated[int, typer.Option(help="Processes of a study or sweep; 0: all cores")] = 0,
    fmi_logging: Annotated[bool, typer.Option(help="Print the messages of FMUs")] = False,
    call_timeout: CallTimeout = None,
    run_timeout: RunTimeout = None,
    memory_limit: MemoryLimit = None,
    isolate: Isolate = False,
) -> None:
    """Run an experiment: every variant, then a table and PNG plots."""
    from harness.cli.run_record import RunRecord

    limits = {"call": call_timeout, "run": run_timeout, "memory": memory_limit}
    limits |= {"isolate": isolate or None}
    changed = settings(set_ or [])
    changed |= limit_settings(changed, limits)
    with notices(), opened_experiment(experiment, changed) as loaded:
        chosen = tuple(variant or loaded.variants)
        for name in chosen:
            loaded.variant_spec(name)
        folder = output or registry.run_folder(loaded.name)
        if not study and not sweep:
            record = RunRecord(loaded, chosen, changed)
            record.write(folder)
            finish_run(record, folder, logging=fmi_logging)
            return
        _announce(loaded)
        _repeat(loaded, chosen, folder, jobs, study=study)


def limit_settings(
    changed: dict[str, Any], limits: Mapping[str, float | str | None]
) -> dict[str, Any]:
    """The table `limits` of the settings with those given by flags."""
    given = {name: value for name, value in limits.items() if value is not None}
    return {"limits": {**changed.get("limits", {}), **given}} if given else {}


def finish_run(
    record: RunRecord, folder: Path, *, logging: bool = False, resume: bool = False
) -> None:
    """Run what the folder lacks, and report on all of it."""
    _announce(record.experiment)
    try:
        _run(record, folder, echo=_echo if logging else None, resume=resume)
    except KeyboardInterrupt as fault:
        raise HarnessError(
            f"{fault or 'interrupted by Ctrl-C'}; the rows so far are in {folder}, and "
            f"`fmu-harness resume {folder}` goes on with them"
        ) from None


def _announce(loaded: Experiment) -> None:
    say(f"{loaded.name}: {loaded.spec.title}", style="bold")


def _run(record: RunRecord, folder: Path, *, echo: Echo | None, resume: bool) -> None:
    from harness.experiment.report import metrics_table, signals_table, write_report

    loaded = record.experiment
    results, faults = {}, {}
    with bar() as shown:
        for name in record.variants:
            moved = _progress(shown, loaded.label(name))
            try:
                results[name] = loaded.run(
                    name, folder / name, progress=moved, echo=echo, resume=resume
                )
            except HarnessError as fault:
                if fault.result is None:
                    raise
                faults[name] = fault
                results[name] = fault.result
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
    """The study of all variants, or the sweep of some."""
    from harness.experiment.parallel import Workers
    from harness.experiment.study import run_study, study_tables
    from harness.experiment.sweep import run_sweep, write_sweep
    from harness.results.atomic import check_free

    check_free(folder, "study.csv" if study else "regions.csv")
    with bar() as shown, Workers(jobs, isolated=True) as workers:
        moved = _progress(shown, "study" if study else "sweep")
        if study:
            found = run_study(loaded, workers=workers, progress=moved)
        else:
            regions = run_sweep(loaded, variants, workers=workers, progress=moved)
    if study:
        console().print(*study_tables(loaded, found), sep="\n")
        written = [found.write(folder)]
    else:
        for name, region in regions.items():
            say(f"{loaded.label(name)}: {100 * region.share:.1f} % of the points inside")
        written = write_sweep(loaded, regions, folder)
    for path in written:
        say(f"written: {path}")


def _progress(shown: Progress, name: str) -> Callable[[float], None]:
    task = shown.add_task(name, total=1.0)
    return lambda share: shown.update(task, completed=share)


def _echo(component: str, message: object) -> None:
    say(f"{component} {message}", stderr=True)
