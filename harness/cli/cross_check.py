"""The files of the FMI cross-check beside an FMU: `{Model}_ref.opt` and `{Model}_in.csv`.

Options are lines "name, value" (or
"name=value"): StartTime, StopTime, StepSize (0: variable), RelTol, OutputIntervalLength.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

from harness.errors import UsageError
from harness.participants.settings import Request

_KEYS = {
    "starttime": "start_time", "stoptime": "stop_time", "stepsize": "step_size",
    "reltol": "relative_tolerance", "tolerance": "relative_tolerance",
    "outputintervallength": "output_interval",
}  # fmt: skip


def beside(fmu: Path, tail: str) -> Path | None:
    """The file of the layout that ends in `tail`, None where it is not there."""
    path = fmu.with_suffix("")
    path = path.with_name(path.name + tail)
    return path if path.is_file() else None


def read_options(path: Path) -> Request:
    """The request that a `_ref.opt` file states; raises `UsageError` naming a line it cannot be."""
    found: dict[str, float] = {}
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as fault:
        raise UsageError(f"{path} cannot be read: {fault}; give a readable text") from fault
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
            raise UsageError(
                f"{path}, line {number}: {line!r} holds no number; write it as in StopTime, 10"
            ) from fault
        if math.isfinite(value) and not (value == 0.0 and key not in ("start_time", "stop_time")):
            found[key] = value
    return Request(**found)  # type: ignore[arg-type]
