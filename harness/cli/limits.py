"""The flags by which a command limits what FMUs may use, and its end by Ctrl-C."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Any

import typer

from harness.errors import HarnessError

if TYPE_CHECKING:
    from harness.process.limits import Limits

CallTimeout = Annotated[
    float | None, typer.Option(help="Seconds that one call into an FMU may take")
]
RunTimeout = Annotated[float | None, typer.Option(help="Seconds that a run may take")]
MemoryLimit = Annotated[str | None, typer.Option(help="Memory that a run may hold, as in '4 GiB'")]
Isolate = Annotated[
    bool, typer.Option(help="Let FMUs write no file but their own and open no connection")
]
Validate = Annotated[
    bool, typer.Option(help="Refuse an FMU whose description leaves open what it means")
]


def limits_of(call: float | None, run: float | None, memory: str | None, isolate: bool) -> Limits:
    """The limits that the flags mean; raises `UsageError`."""
    from harness.process.limits import Limits, memory_size

    given: dict[str, Any] = {} if call is None else {"call": call}
    size = None if memory is None else memory_size(memory)
    return Limits(**given, run=run, memory=size, isolate=isolate)


@contextmanager
def interruptible() -> Iterator[None]:
    """While open, Ctrl-C ends the command with a sentence and exit code 1."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        raise HarnessError(str(interrupt) or "interrupted by Ctrl-C") from None
