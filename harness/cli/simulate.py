"""`fmu-harness simulate`: run one FMU of any version and kind; CSV in, CSV and a plot out."""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path
from tempfile import mkdtemp
from typing import TYPE_CHECKING, Annotated

import typer

from harness.cli import options
from harness.cli.tables import show_table
from harness.cli.terminal import bar, echo, note, say, table
from harness.errors import HarnessError
from harness.interrupts import TerminatedError

if TYPE_CHECKING:
    from harness.fmi.fmu import Fmu
    from harness.results.result import Result

Number = float | None
_SHOWN = 40


def simulate_command(
    fmu: Annotated[Path, typer.Argument(help="An .fmu file, FMI 1, 2 or 3")],
    start_time: Annotated[Number, typer.Option(help="Start (s)")] = None,
    stop_time: Annotated[Number, typer.Option(help="Stop (s)")] = None,
    step_size: Annotated[Number, typer.Option(help="Communication step (s)")] = None,
    output_interval: Annotated[Number, typer.Option(help="Distance of recorded rows (s)")] = None,
    input_file: Annotated[
        Path | None, typer.Option(help="CSV of inputs and tunable parameters over time")
    ] = None,
    output_file: Annotated[Path | None, typer.Option(help="CSV to write")] = None,
    start_values: Annotated[
        list[str] | None, typer.Option(help="name=value or name=value[unit]; repeatable")
    ] = None,
    relative_tolerance: Annotated[Number, typer.Option(help="Of the FMU or the solver")] = None,
    interface_type: Annotated[
        str | None, typer.Option(help="co-simulation or model-exchange")
    ] = None,
    solver: Annotated[
        str, typer.Option(help="For model exchange: cvode, euler, rk4 or dopri5")
    ] = "cvode",
    output_variables: Annotated[
        list[str] | None,
        typer.Option(help="Record these, * and ? allowed; repeatable; the outputs when absent"),
    ] = None,
    event_mode: Annotated[
        bool, typer.Option(help="Handle events in FMI 3 co-simulation where the FMU can")
    ] = True,
    show_plot: Annotated[bool, typer.Option("--show-plot", help="Draw and open a plot")] = False,
    plot_file: Annotated[Path | None, typer.Option(help="PNG, SVG or PDF to draw")] = None,
    fmi_logging: options.FmiLogging = False,
    validate_against: Annotated[
        Path | None, typer.Option(help="CSV with a reference; exit code 1 where it differs")
    ] = None,
    time_band: Annotated[
        Number, typer.Option(help="Half width of the band in time (s); one step when absent")
    ] = None,
    value_band: Annotated[
        float, typer.Option(help="Half width of the band in value, relative to the range")
    ] = 0.01,
    validate: options.Validate = True,
    compile_: options.Compile = False,
    allow_not_finite: Annotated[
        bool, typer.Option(help="Take NaN and infinity for values like others")
    ] = False,
    call_timeout: options.CallTimeout = None,
    run_timeout: options.RunTimeout = None,
    memory_limit: options.MemoryLimit = None,
    isolate: options.Isolate = False,
) -> None:
    """Simulate one FMU. Cross-check files beside it are used where no option says otherwise."""
    from harness.cli.cross_check import beside, read_options
    from harness.fmi.fmu import Fmu
    from harness.fmi.sources import compiled
    from harness.fmi.start_values import parse_assignment
    from harness.participants.settings import Request
    from harness.simulation import simulate

    given = Request(
        interface_type, start_time, stop_time, step_size, output_interval, relative_tolerance,
        solver,
    )  # fmt: skip
    stated, driven = beside(fmu, "_ref.opt"), beside(fmu, "_in.csv")
    if stated is not None:
        said = {name: value for name, value in vars(given).items() if value is not None}
        given = replace(read_options(stated), **said)
        note(f"options are taken from {stated}")
    if input_file is None and driven is not None:
        input_file = driven
        note(f"inputs are taken from {driven}")
    limits = options.limits_of(call_timeout, run_timeout, memory_limit, isolate)
    fmu = compiled(fmu, validate=validate) if compile_ else fmu
    with Fmu(fmu, validate=validate) as opened:
        if validate_against is not None and output_variables is None:
            output_variables = _recorded(opened, validate_against)
        starts = [parse_assignment(opened.description, text) for text in start_values or []]
        fault: HarnessError | TerminatedError | None = None
        try:
            with bar(opened.description.name) as moved:
                result = simulate(
                    fmu, **vars(given), start_values=dict(starts), inputs=input_file,
                    output_variables=output_variables, event_mode=None if event_mode else False,
                    validate=validate, progress=moved, echo=echo if fmi_logging else None,
                    limits=limits,
                )  # fmt: skip
        except (HarnessError, TerminatedError) as caught:
            if caught.result is None:
                raise
            fault, result = caught, caught.result
        for one in result.notes:
            note(one)
        _summary(result)
        _write(result, output_file, plot_file, show_plot)
        if fault is None and result.not_finite and not allow_not_finite:
            more = f" (and {len(result.not_finite) - 1} more variables)"
            fault = HarnessError(
                f"FMU {fmu}: {result.not_finite[0]}{more if len(result.not_finite) > 1 else ''}; "
                "--allow-not-finite takes such values"
            )
        if fault is not None:
            note(_kept(result, output_file))
            raise fault
        if validate_against is not None:
            _validate(result, validate_against, time_band, value_band)


def _kept(result: Result, output_file: Path | None) -> str:
    """What became of the rows of a run that ended early."""
    if not len(result.time):
        return "there are no rows"
    until = f"{len(result.time)} rows until t = {result.time[-1]:.9g} s"
    if output_file is not None:
        return f"{until} are in {output_file}"
    return f"{until} were computed; --output-file FILE keeps them"


def _recorded(opened: Fmu, reference: Path) -> list[str]:
    """The default outputs and the columns of the reference."""
    from harness.master.recorded import select
    from harness.results.csv_files import read_reference

    d = opened.description
    known = [v.name for v in select(d, None)]
    for column in read_reference(reference, {}).columns:
        whole = column if column in d.variables else column.partition("[")[0]
        known += [whole] if whole in d.variables else []
    return list(dict.fromkeys(known))


def _summary(result: Result) -> None:
    if not result.manifest.fmus:  # the FMU's process died; there is nothing but the rows
        return
    rows = []
    for name in result.names[:_SHOWN] if len(result.time) else ():
        values = result[name]
        if result.column(name).dtype is None:
            cells = [repr(str(values[0])), repr(str(values[-1])), "", "", ""]
        else:
            ends = (values[0], values[-1], min(values), max(values))
            cells = [*(f"{float(v):.6g}" for v in ends), result.unit(name)]
        rows.append((name, *cells))
    headings = ("variable", "first", "last", "smallest", "largest", "unit")
    title = f"{_instance(result, ', {}')}, {len(result.time)} rows"
    show_table(table(headings, rows, title=title, right=headings[1:-1]))
    if len(result.names) > _SHOWN:
        say(f"… {len(result.names) - _SHOWN} more variables")


def _write(result: Result, csv: Path | None, plot: Path | None, show: bool) -> None:
    if csv is not None:
        from harness.results.csv_files import write_csv

        write_csv(result, csv)
        say(f"written: {csv}")
    if (plot is not None or show) and result.numeric and len(result.time) and result.manifest.fmus:
        from harness.results.plots import save_figure

        if plot is None and not _has_display():
            note("there is no display to show the plot on; --plot-file FILE draws it into a file")
            return
        path = plot or Path(mkdtemp(prefix="fmu-harness-")) / f"{_instance(result, '')}.png"
        save_figure(path, result.plot(title=_instance(result, " ({})")))
        say(f"written: {path}")
        if show and _has_display():
            typer.launch(str(path))


def _has_display() -> bool:
    """Whether a picture can be shown here."""
    return sys.platform != "linux" or any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY")))


def _instance(result: Result, kind: str) -> str:
    """The name of the FMU and the kind of interface that was run, in the form `kind`."""
    manifest = result.manifest
    return manifest.fmus[0].instance + kind.format(manifest.experiment["interface_type"])


def _validate(result: Result, path: Path, time_band: float | None, value_band: float) -> None:
    from harness.results.comparison import compare_with_file

    found, band = compare_with_file(result, path, time_band, value_band)
    headings = ("variable", "rows inside", "largest difference", "verdict")
    rows = []
    for one in found:
        verdict = "agrees" if one.agrees else f"leaves the band at {one.first_outside} s"
        rows.append((one.name, f"{one.inside} of {one.judged}", f"{one.largest:.3g}", verdict))
    title = f"band: {band.time:g} s in time, {100 * band.relative:g} % of the range in value"
    show_table(table(headings, rows, title=title, right=headings[1:]))
    wrong = [one for one in found if not one.agrees]
    if wrong:
        raise HarnessError(
            f"{len(wrong)} of {len(found)} variables leave the band around {path}: "
            + "; ".join(f"{one.name} first at t = {one.first_outside} s" for one in wrong[:3])
        )
