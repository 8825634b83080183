"""`fmu-harness run`: run an experiment with all its variants; table, plots and rows in a folder."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from harness import registry
from harness.cli.notices import notices
from harness.cli.terminal import console
from harness.cli.values import settings
from harness.errors import HarnessError, UsageError


def run_command(
    experiment: Annotated[str, typer.Argument(help="Name (see `list`) or path of a TOML file")],
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
    jobs: Annotated[int, typer.Option(help="Processes of a study; 0: one a core")] = 0,
    fmi_logging: Annotated[bool, typer.Option(help="Print the messages of FMUs")] = False,
) -> None:
    """Run an experiment: every variant, then a table and PNG plots."""
    from harness.experiment.experiment import Experiment
    from harness.experiment.report import metrics_table, write_report
    from harness.experiment.study import run_study, study_tables

    out = console()
    with notices():
        loaded = Experiment.load(registry.experiment(experiment), settings(set_ or []))
        chosen = tuple(variant or loaded.variants)
        for name in chosen:
            loaded.variant_spec(name)
        folder = output or _run_folder(loaded.name)
        out.print(f"{loaded.name}: {loaded.spec.title}", markup=False, soft_wrap=True, style="bold")
        if study:
            if loaded.spec.study is None:
                raise UsageError(f"{loaded.path} has no table [study]")
            with _bar() as bar:
                task = bar.add_task("study", total=1.0)
                found = run_study(
                    loaded, jobs=jobs, progress=lambda share: bar.update(task, completed=share)
                )
            for table in study_tables(loaded, found):
                out.print(table)
            out.print(f"written: {found.write(folder)}", markup=False, soft_wrap=True)
            return
        results, faults = {}, {}
        echo = _echo if fmi_logging else None
        with _bar() as bar:
            for name in chosen:
                task = bar.add_task(loaded.label(name), total=1.0)
                try:
                    results[name] = loaded.run(
                        name,
                        folder / name,
                        progress=lambda share, task=task: bar.update(task, completed=share),  # type: ignore[misc]
                        echo=echo,
                    )
                except HarnessError as fault:
                    if fault.result is None:
                        raise
                    faults[name] = fault
                    results[name] = fault.result
        out.print(metrics_table(loaded, results))
        for path in write_report(loaded, results, folder):
            out.print(f"written: {path}", markup=False, soft_wrap=True)
    if faults:
        raise HarnessError("\n".join(f"{loaded.label(n)}: {f}" for n, f in faults.items()))


def _bar() -> Progress:
    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=console(stderr=True),
    )


def _run_folder(name: str) -> Path:
    stamp = datetime.now().strftime("%Y%m%d-%H%M%S")
    folder = Path("runs") / f"{name.replace('/', '-')}-{stamp}"
    number = 1
    while folder.exists():
        number += 1
        folder = folder.with_name(f"{name.replace('/', '-')}-{stamp}-{number}")
    return folder


def _echo(component: str, message: object) -> None:
    console(stderr=True).print(f"{component} {message}", markup=False, soft_wrap=True)
