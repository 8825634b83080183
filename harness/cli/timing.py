"""`fmu-harness timing`: the schedule of one cycle, and the measured delays of the loop."""

from __future__ import annotations

import warnings
from itertools import groupby
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table

from harness.cli.experiments import opened_experiment
from harness.cli.limits import interruptible
from harness.cli.notices import notices
from harness.cli.terminal import console
from harness.cli.values import settings
from harness.clock import show

if TYPE_CHECKING:
    from harness.master.plan.planner import Plan
    from harness.master.timing import Arrival
    from harness.system.graph import Endpoint

_SHOWN = 60  # lines of the schedule


def timing_command(
    experiment: Annotated[
        str, typer.Argument(help="Name (see `list`), or path of a TOML, .ssp or .ssd file")
    ],
    variant: Annotated[str | None, typer.Option(help="Variant; the first when absent")] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="Change a key of the file: key.sub=value")
    ] = None,
) -> None:
    """Print the schedule of one cycle and, by pulsing the loop, the measured delays."""
    from harness.master.opened import opened
    from harness.master.run import plan_system
    from harness.master.timing import measure_delays
    from harness.process.task import Teller, run_task

    out = console()
    with notices(), interruptible(), opened_experiment(experiment, settings(set_ or [])) as loaded:
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
    out.print(f"{loaded.name} ({loaded.label(chosen)}), one cycle of {show(plan.cycle_ns)}:")
    _print_schedule(out, plan)
    for source, arrivals in delays.items():
        out.print(_delays(source, arrivals))


def _print_schedule(out: Console, plan: Plan) -> None:
    from harness.master.timing import schedule

    lines = list(schedule(plan))
    for instant, group in groupby(lines[:_SHOWN], key=lambda line: line[0]):
        for i, (_, text) in enumerate(group):
            out.print(f"  {instant if i == 0 else '':>10}  {text}", markup=False, soft_wrap=True)
    if len(lines) > _SHOWN:
        out.print(f"  … {len(lines) - _SHOWN} more actions in the cycle")


def _delays(source: Endpoint, arrivals: tuple[Arrival, ...]) -> Table:
    table = Table(title=f"a pulse in {source}, as measured", title_justify="left")
    for title in ("first seen in", "at", "delay", "in samples"):
        table.add_column(title, justify="left" if title == "first seen in" else "right")
    for arrival in arrivals:
        if arrival.arrived_ns is None or arrival.samples is None:
            table.add_row(str(arrival.port), "never", "–", "–")
        else:
            delay = show(arrival.arrived_ns - arrival.computed_ns) if arrival.samples else "0"
            table.add_row(
                str(arrival.port), show(arrival.arrived_ns), delay, f"{arrival.samples:g}"
            )
    return table
