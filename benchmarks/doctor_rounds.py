"""The doctor examines folders of FMUs, and writes one line for each kind of interface.

    python -m benchmarks.doctor_rounds FOLDER [FOLDER …] [--markdown FILE] [--json FILE]

FOLDER is searched for `.fmu` files. The exit code is 1 where a check failed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.errors import HarnessError
from harness.inspection.doctor import Diagnosis, examine
from harness.inspection.finding import Finding, Verdict

HEAD = ("FMU", "FMI", "kind", "passed", "not offered", "what failed", "not allowed in the loop")


@dataclass(frozen=True)
class Visit:
    """One FMU: its diagnosis, or the sentence that refused it."""

    path: Path
    label: str
    diagnosis: Diagnosis | None
    refusal: str = ""

    def lines(self) -> Iterator[tuple[str, ...]]:
        """The cells of its lines, one line for each kind of interface."""
        if self.diagnosis is None:
            yield (
                self.label,
                "",
                "refused",
                "",
                "",
                self.refusal.replace(f"FMU {self.path}", "it"),
                "",
            )
            return
        d = self.diagnosis
        by_kind: dict[str, list[Finding]] = {}
        for finding in d.findings:
            by_kind.setdefault(finding.interface_type, []).append(finding)
        for kind, found in by_kind.items():
            counts = [
                str(sum(f.verdict is verdict for f in found))
                for verdict in (Verdict.PASSED, Verdict.NOT_OFFERED)
            ]
            failed = [f"{f.check}: {f.detail}" for f in found if f.verdict is Verdict.FAILED]
            stepping = kind == "co-simulation"
            yield (self.label, d.description.fmi_version, kind, *counts, "; ".join(failed) or "–",
                   _refused(d) if stepping else "–")  # fmt: skip

    def as_data(self) -> dict[str, Any]:
        """Plain values for JSON."""
        if self.diagnosis is None:
            return {"fmu": str(self.path), "refused": self.refusal}
        return self.diagnosis.as_data()


def _refused(d: Diagnosis) -> str:
    loop = [a for a in d.allowances if not a.use.startswith("simulate")]
    refused = [a.use for a in loop if not a.allowed]
    if len(refused) == len(loop):
        return f"all: {next(a.reason for a in loop)}"
    return ", ".join(refused) or "–"


def visit(path: Path, label: str) -> Visit:
    """Examine one FMU."""
    try:
        return Visit(path, label, examine(path))
    except HarnessError as fault:
        return Visit(path, label, None, str(fault))


def markdown(visits: list[Visit]) -> str:
    """The table."""
    lines = [HEAD, ("---",) * len(HEAD), *(line for one in visits for line in one.lines())]
    return "".join(
        "| " + " | ".join(c.replace("|", "\\|") for c in line) + " |\n" for line in lines
    )


def main() -> int:
    """Examine, print the table, and return 1 where a check failed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--markdown", type=Path, help="write the table")
    parser.add_argument("--json", type=Path, help="write all findings")
    given = parser.parse_args()
    visits = []
    for folder in given.folders:
        for path in sorted(folder.rglob("*.fmu")):
            print(f"{path} …", flush=True)
            visits.append(visit(path, str(path.relative_to(folder).with_suffix(""))))
    print(markdown(visits))
    if given.markdown:
        given.markdown.write_text(markdown(visits), encoding="utf-8")
    if given.json:
        text = json.dumps([one.as_data() for one in visits], indent=2, ensure_ascii=False)
        given.json.write_text(text + "\n", encoding="utf-8")
    return int(any(one.diagnosis is not None and not one.diagnosis.healthy for one in visits))


if __name__ == "__main__":
    raise SystemExit(main())
