"""`fmu-harness`: the command line, and the only place where faults become exit codes.

0 done, 1 the run or check failed, 2 the command cannot be meant. A fault is printed as its
sentence; a traceback would be a defect of the harness.
"""

from __future__ import annotations

import atexit
import gc
import logging
import os
import sys
import warnings
from contextlib import suppress
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from harness.cli import (
    build,
    describe,
    doctor,
    export,
    info,
    listing,
    reproduce,
    run,
    simulate,
    timing,
    validate,
    verify,
)
from harness.cli.terminal import note, say
from harness.errors import ExperimentError, GraphError, HarnessError, TimingError, UsageError

MEANINGLESS = (UsageError, ExperimentError, GraphError, TimingError)
"""The faults of a command that cannot be meant."""


class Commands(TyperGroup):
    """Commands whose warnings are printed as notes, each once, and which Ctrl-C ends with a
    sentence."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command that is named."""
        seen: set[str] = set()

        def show(message: Warning | str, *_: Any, **__: Any) -> None:
            if str(message) not in seen:
                seen.add(str(message))
                note(message)

        with warnings.catch_warnings():
            warnings.simplefilter("default")
            warnings.showwarning = show
            try:
                return super().invoke(ctx)
            except KeyboardInterrupt as interrupt:
                raise HarnessError(str(interrupt) or "interrupted by Ctrl-C") from None


app = typer.Typer(
    name="fmu-harness",
    cls=Commands,
    help="Closes the loop between plant FMUs and digital controllers.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def _print_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        print(f"fmu-harness {version('fmu-harness')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", help="Print the version", callback=_print_version, is_eager=True),
    ] = False,
) -> None:
    """Closes the loop between plant FMUs and digital controllers."""


for command in (
    listing.list_command, describe.describe_command, run.run_command, run.resume_command,
    reproduce.reproduce_command, build.build_command, export.export_command,
    simulate.simulate_command, info.info_command, doctor.doctor_command,
    validate.validate_command, timing.timing_command, verify.verify_command,
):  # fmt: skip
    app.command(command.__name__.removesuffix("_command"))(command)


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and exit.

    What was registered for the exit is done and the streams are flushed; the interpreter is not
    taken apart, which would keep the terminal waiting long after Ctrl-C.
    """
    gc.set_threshold(100_000)  # what is opened lives to the end; to look through it often is slow
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # where it may keep its fonts
    code = run_command_line(arguments)
    with suppress(OSError, ValueError):
        atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):
            stream.flush()
    os._exit(code)


def run_command_line(arguments: list[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    try:
        app(args=arguments)
    except SystemExit as done:  # how typer ends, also after a usage error of its own
        return done.code if isinstance(done.code, int) else int(done.code is not None)
    except (HarnessError, OSError) as fault:  # OSError: as where the temporary folder is full
        say(f"error: {fault}", stderr=True)
        return 2 if isinstance(fault, MEANINGLESS) else 1
    return 0


if __name__ == "__main__":
    main()
