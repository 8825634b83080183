"""The files of the FMI cross-check beside an FMU: `{Model}_ref.opt`, `_in.csv`, `_ref.csv`.

Newer collections have `_out.csv` in the place of `_ref.csv`. Options are lines "name, value" (or
"name=value"): StartTime, StopTime, StepSize (0: variable), RelTol, OutputIntervalLength.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

from harness.errors import UsageError
from harness.participants.settings import Request

_KEYS = {
    "starttime": "start_time", "stoptime": "stop_time", "stepsize": "step_size",
    "reltol": "relative_tolerance", "tolerance": "relative_tolerance",
    "outputintervallength": "output_interval",
}  # fmt: skip


@dataclass(frozen=True)
class CrossCheck:
    """What lies beside an FMU; None for what does not."""

    options: Path | None = None
    inputs: Path | None = None
    reference: Path | None = None


def find_cross_check(fmu: Path) -> CrossCheck:
    """The files of the layout that are there."""
    stem = fmu.with_suffix("")

    def beside(*tails: str) -> Path | None:
        paths = (stem.with_name(stem.name + tail) for tail in tails)
        return next((path for path in paths if path.is_file()), None)

    return CrossCheck(beside("_ref.opt"), beside("_in.csv"), beside("_ref.csv", "_out.csv"))


def read_options(path: Path) -> Request:
    """The request that a `_ref.opt` file states; raises `UsageError` naming a line it cannot be."""
    found: dict[str, float] = {}
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as fault:
        raise UsageError(f"{path} cannot be read: {fault}") from fault
    for number, line in enumerate(lines, start=1):
        text = line.strip().strip('"')
        if not text or text.startswith(("#", "//")):
            continue
        parts = [part.strip().strip('"') for part in re.split(r"[,=;]", text, maxsplit=1)]
        key = _KEYS.get(parts[0].lower().replace("_", ""))
        if key is None:
            continue
        try:
            value = float(parts[1])
        except (IndexError, ValueError) as fault:
            raise UsageError(f"{path}, line {number}: {line!r} holds no number") from fault
        if math.isfinite(value) and not (value == 0.0 and key not in ("start_time", "stop_time")):
            found[key] = value
    return Request(**found)  # type: ignore[arg-type]
