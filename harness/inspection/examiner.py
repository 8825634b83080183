"""The disposable process of an examination: `python -m harness.inspection.examiner FMU OUT NAMES`.

Writes one JSON line to OUT when a check begins and one when it has ended, so that whoever started
it knows where it died. It refuses to print and to recover from anything but a fault that the
harness itself reports.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

from harness.errors import HarnessError
from harness.fmi.fmu import Fmu
from harness.inspection.checks import CHECKS
from harness.inspection.finding import failed
from harness.inspection.subject import Subject
from harness.supervision.process import die_with_parent


def examine(path: Path, out: Path, names: list[str]) -> None:
    """Run the checks called `names`, in order."""
    with Fmu(path) as fmu, out.open("a", encoding="utf-8", buffering=1) as lines:
        subject = Subject(fmu)
        for name in names:
            lines.write(json.dumps({"begins": name}) + "\n")
            try:
                finding = CHECKS[name](subject)
            except HarnessError as fault:
                finding = failed(str(fault))
            lines.write(json.dumps(replace(finding, check=name).as_data()) + "\n")


if __name__ == "__main__":
    die_with_parent()
    examine(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
