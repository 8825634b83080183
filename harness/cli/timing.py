"""`fmu-harness timing`: the schedule of one cycle, and the measured delays of the loop."""

from __future__ import annotations

import warnings
from itertools import groupby
from typing import TYPE_CHECKING, Annotated

import typer

from harness.cli.options import (
    Changes,
    Compile,
    ExperimentName,
    Validate,
    for_fmus,
    opened_experiment,
    settings,
)
from harness.cli.tables import show_table
from harness.cli.terminal import say, table
from harness.clock import show

if TYPE_CHECKING:
    from rich.table import Table

    from harness.master.plan.planner import Plan
    from harness.master.timing import Arrival
    from harness.system.graph import Endpoint

_SHOWN = 60  # lines of the schedule


def timing_command(
    experiment: ExperimentName,
    variant: Annotated[str | None, typer.Option(help="Variant; the first when absent")] = None,
    set_: Changes = None,
    validate: Validate = True,
    compile_: Compile = False,
) -> None:
    """Print the schedule of one cycle and, by pulsing the loop, the measured delays."""
    from harness.master.opened import opened
    from harness.master.run import plan_system
    from harness.master.timing import measure_delays
    from harness.process.task import Teller, run_task

    with opened_experiment(experiment, settings(for_fmus(set_, validate, compile_))) as loaded:
        chosen = variant or loaded.variants[0]
        system = loaded.bench(chosen).system()
        with opened(system) as fmus:
            plan = plan_system(system, fmus)
        for note in plan.notes:
            warnings.warn(note, stacklevel=2)

        def measure(teller: Teller) -> dict[Endpoint, tuple[Arrival, ...]]:
            teller.show_loops()
            with opened(system) as fmus:
                return measure_delays(system, fmus)

        delays = run_task(measure, limits=loaded.variant_spec(chosen).run_limits())
    say(f"{loaded.name} ({loaded.label(chosen)}), one cycle of {show(plan.cycle_ns)}:")
    _print_schedule(plan)
    for source, arrivals in delays.items():
        show_table(_delays(source, arrivals))


def _print_schedule(plan: Plan) -> None:
    from harness.master.timing import schedule

    lines = list(schedule(plan))
    for instant, group in groupby(lines[:_SHOWN], key=lambda line: line[0]):
        for i, (_, text) in enumerate(group):
            say(f"  {instant if i == 0 else '':>10}  {text}")
    if len(lines) > _SHOWN:
        say(f"  … {len(lines) - _SHOWN} more actions in the cycle")


def _delays(source: Endpoint, arrivals: tuple[Arrival, ...]) -> Table:
    from rich import box

    rows = []
    for a in arrivals:
        cells = ("never", "–", "–")
        if a.arrived_ns is not None and a.samples is not None:
            delay = show(a.arrived_ns - a.computed_ns) if a.samples else "0"
            cells = (show(a.arrived_ns), delay, f"{a.samples:g}")
        rows.append((str(a.port), *cells))
    headings = ("first seen in", "at", "delay", "in samples")
    title = f"a pulse in {source}, as measured"
    return table(headings, rows, title=title, right=headings[1:], box=box.HEAVY_HEAD)
