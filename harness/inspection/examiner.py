"""The disposable process of an examination:

    python -m harness.inspection.examiner FMU OUT SCRATCH INTERFACE_TYPE NAME…

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
from harness.inspection.catalogue import CHECKS, ELSEWHERE
from harness.inspection.finding import VerdictError, failed
from harness.inspection.subject import Subject
from harness.process.fork import die_with_parent
from harness.system.policy import interface


def examine(path: Path, out: Path, scratch: Path, interface_type: str, names: list[str]) -> None:
    """Run the checks called `names`, in order; who asks for them has judged the description."""
    with Fmu(path, validate=False) as fmu, out.open("a", encoding="utf-8", buffering=1) as lines:
        subject = Subject(fmu, interface(interface_type, fmu.description), scratch)
        known = CHECKS[interface_type] | ELSEWHERE
        for name in names:
            lines.write(json.dumps({"begins": name}) + "\n")
            try:
                finding = known[name](subject)
            except VerdictError as end:
                finding = end.finding
            except HarnessError as fault:
                finding = failed(str(fault))
            found = replace(finding, check=name, interface_type=interface_type)
            lines.write(json.dumps(found.as_data()) + "\n")


if __name__ == "__main__":
    die_with_parent()
    fmu_path, out_path, scratch_path, kind, *wanted = sys.argv[1:]
    examine(Path(fmu_path), Path(out_path), Path(scratch_path), kind, wanted)
