"""`fmu-harness run`: run an experiment with all its variants; table, plots and rows in a folder."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.progress import Progress, TaskID

from harness import registry
from harness.cli.experiments import opened_experiment
from harness.cli.limits import CallTimeout, Isolate, MemoryLimit, RunTimeout
from harness.cli.notices import notices
from harness.cli.progress import bar
from harness.cli.terminal import console
from harness.cli.values import settings
from harness.errors import HarnessError

if TYPE_CHECKING:
    from harness.bench import Echo
    from harness.cli.run_record import RunRecord
    from harness.experiment.experiment import Experiment


def run_command(
    experiment: Annotated[
        str, typer.Argument(help="Name (see `list`), or path of a TOML, .ssp or .ssd file")
    ],
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="Change a key of the file: key.sub=value")
    ] = None,
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

    limits: dict[str, float | str | None]
    limits = {"call": call_timeout, "run": run_timeout, "memory": memory_limit}
    limits |= {"isolate": True} if isolate else {}
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
        _title(loaded)
        written = _study(loaded, folder, jobs) if study else _sweep(loaded, chosen, folder, jobs)
        _name(written)


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
    _title(record.experiment)
    echo = _echo if logging else None
    try:
        _name(_run(record.experiment, record.variants, folder, echo, resume=resume))
    except KeyboardInterrupt as fault:
        raise HarnessError(
            f"{fault or 'interrupted by Ctrl-C'}; the rows so far are in {folder}, and "
            f"`fmu-harness resume {folder}` goes on with them"
        ) from None


def _title(loaded: Experiment) -> None:
    title = f"{loaded.name}: {loaded.spec.title}"
    console().print(title, markup=False, soft_wrap=True, style="bold")


def _name(written: Iterable[Path]) -> None:
    for path in written:
        console().print(f"written: {path}", markup=False, soft_wrap=True)


def _run(
    loaded: Experiment,
    variants: tuple[str, ...],
    folder: Path,
    echo: Echo | None,
    *,
    resume: bool = False,
) -> Iterator[Path]:
    from harness.experiment.report import metrics_table, signals_table, write_report

    results, faults = {}, {}
    with bar() as shown:
        for name in variants:
            task = shown.add_task(loaded.label(name), total=1.0)
            moved = partial(_moved, shown, task)
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
    yield from write_report(loaded, results, folder)
    if faults:
        raise HarnessError("\n".join(f"{loaded.label(n)}: {f}" for n, f in faults.items()))


def _study(loaded: Experiment, folder: Path, jobs: int) -> Iterator[Path]:
    from harness.experiment.parallel import Workers
    from harness.experiment.study import run_study, study_tables
    from harness.results.atomic import check_free

    check_free(folder, "study.csv")
    with bar() as shown:
        moved = partial(_moved, shown, shown.add_task("study", total=1.0))
        with Workers(jobs, isolated=True) as workers:
            found = run_study(loaded, workers=workers, progress=moved)
    for table in study_tables(loaded, found):
        console().print(table)
    yield found.write(folder)


def _sweep(
    loaded: Experiment, variants: tuple[str, ...], folder: Path, jobs: int
) -> Iterator[Path]:
    from harness.experiment.parallel import Workers
    from harness.experiment.sweep import run_sweep, write_sweep
    from harness.results.atomic import check_free

    check_free(folder, "regions.csv")
    with bar() as shown:
        moved = partial(_moved, shown, shown.add_task("sweep", total=1.0))
        with Workers(jobs, isolated=True) as workers:
            regions = run_sweep(loaded, variants, workers=workers, progress=moved)
    for name, region in regions.items():
        label = loaded.label(name)
        console().print(f"{label}: {100 * region.share:.1f} % of the points inside", markup=False)
    yield from write_sweep(loaded, regions, folder)


def _moved(shown: Progress, task: TaskID, share: float) -> None:
    shown.update(task, completed=share)


def _echo(component: str, message: object) -> None:
    console(stderr=True).print(f"{component} {message}", markup=False, soft_wrap=True)
