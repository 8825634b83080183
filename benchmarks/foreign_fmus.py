"""Other people's FMUs: ours against FMPy's `simulate_fmu` with the same step.

    python -m benchmarks.foreign_fmus FOLDER [FOLDER …] [--timeout S] [--json FILE]
        [--markdown FILE] [--select TEXT]

FOLDER is searched for `.fmu` files. Every interface type of each runs on both sides, each in a
process of its own with a time limit: from the FMU's own start time, with its own step (else a
500th of its run) and at most 1000 steps; outputs are compared (where it has none, its first 20
numbers). Model exchange is solved by CVODE at a relative tolerance of 1e-5 on both sides.

An FMU *can run* here where it holds a binary for this platform, or sources. The description is
read by the standard library alone, so what the harness refuses is in the table too.
"""

from __future__ import annotations

import argparse
import zipfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from fmpy import platform, platform_tuple

from benchmarks.foreign import AGREES, Answer, ask, difference, markdown, write_rows

KINDS = {
    "CoSimulation": "co-simulation", "Implementation": "co-simulation",
    "ModelExchange": "model-exchange", "ScheduledExecution": "scheduled-execution",
}  # fmt: skip
"""Interface types by the element that offers them; FMI 1 has no element for model exchange."""
MOST_STEPS = 1000
HEAD = ("FMU", "exporter", "FMI", "kind", "ours", "FMPy", "difference", "s, ours", "s, FMPy")


@dataclass(frozen=True)
class Subject:
    """What the comparison needs to know of an FMU; times in s."""

    path: str
    exporter: str
    version: str
    kinds: tuple[str, ...]
    holds: str
    """"binary" for this platform, else "sources", else "nothing"."""
    start: float
    stop: float
    step: float
    event_mode: bool
    names: tuple[str, ...]


@dataclass(frozen=True)
class Row:
    """One interface type of one FMU; `difference` is None where not both ran."""

    name: str
    exporter: str
    version: str
    kind: str
    holds: str
    ours: str
    fmpy: str
    difference: float | None
    variable: str
    seconds: tuple[float, float]
    refused: str = ""
    """Why the harness ran it with `validate=False` only."""

    @property
    def verdict(self) -> str:
        """One word or two on the pair."""
        if self.holds == "nothing":
            return "no binary"
        if self.difference is not None:
            return "agree" if self.difference <= AGREES else "differ"
        return {(False, False): "neither", (True, False): "ours alone"}.get(
            (not self.ours, not self.fmpy), "FMPy alone"
        )


def examine(path: Path) -> Subject:
    """Read the description; raises what the archive or the XML make the standard library raise."""
    with zipfile.ZipFile(path) as archive:
        members = archive.namelist()
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    version = root.get("fmiVersion", "")
    kinds = tuple(dict.fromkeys(KINDS[e.tag] for e in root if e.tag in KINDS))
    experiment = root.find("DefaultExperiment")
    given = {} if experiment is None else experiment.attrib
    start = float(given.get("startTime", 0.0))
    stop = float(given.get("stopTime", start + 1.0))
    fixed = [e.get("fixedInternalStepSize") for e in root]
    step = float(next((s for s in (*fixed, given.get("stepSize")) if s), 0.0))
    if not 0.0 < step < float("inf"):
        step = float(f"{(stop - start) / 500 or 0.002:.3g}")
    tool = root.get("generationTool") or "not stated"
    return Subject(
        str(path.resolve()), tool, version, kinds or ("model-exchange",), _holds(members),
        start, min(stop, start + MOST_STEPS * step), step,
        any(e.get("hasEventMode") in ("true", "1") for e in root), tuple(_names(root)),
    )  # fmt: skip


def _holds(members: Sequence[str]) -> str:
    folders = (f"binaries/{platform}/", f"binaries/{platform_tuple}/")
    if any(name.startswith(folders) and not name.endswith("/") for name in members):
        return "binary"
    sources = any(name.startswith("sources/") and name.endswith(".c") for name in members)
    return "sources" if sources else "nothing"


def _names(root: ElementTree.Element) -> list[str]:
    """The outputs that hold numbers, else the first numbers."""
    variables = root.find("ModelVariables")
    found: dict[str, str] = {}
    for element in () if variables is None else variables:
        tags = {element.tag, *(child.tag for child in element)}
        if not tags & {"String", "Binary", "Clock"} and element.find("Dimension") is None:
            found[element.get("name", "")] = element.get("causality", "local")
    outputs = [name for name, causality in found.items() if causality == "output"]
    return outputs or [n for n, c in found.items() if c in ("local", "internal")][:20]


def compare(subject: Subject, name: str, seconds: float) -> Iterator[Row]:
    """A row for each interface type."""
    for kind in subject.kinds:
        task: dict[str, Any] = {
            "path": subject.path, "kind": kind, "start": subject.start, "stop": subject.stop,
            "step": subject.step, "names": subject.names, "compiled": subject.holds == "sources",
            "event_mode": subject.event_mode and kind == "co-simulation",
        }  # fmt: skip
        refused = ""
        if subject.holds == "nothing":
            ours = theirs = Answer("no binary")
        else:
            ours, theirs = ask("ours", task, seconds), ask("fmpy", task, seconds)
        if "--no-validate" in ours.words:
            refused = ours.words
            ours = ask("ours", {**task, "validate": False}, seconds)
        apart, variable = None, ""
        if ours.ran and theirs.ran:
            apart, variable = difference(ours.columns, theirs.columns)
        yield Row(
            name, subject.exporter, subject.version, kind, subject.holds, ours.words, theirs.words,
            apart, variable, (ours.seconds, theirs.seconds), refused,
        )  # fmt: skip


def compare_all(folders: Sequence[Path], select: str, seconds: float) -> Iterator[list[Row]]:
    """The rows of each FMU below the folders whose path holds the text `select`."""
    for folder in folders:
        for path in sorted(folder.rglob("*.fmu")):
            name = path.relative_to(folder).as_posix()
            if select not in name or not path.is_file():
                continue
            try:
                subject = examine(path)
            except Exception as fault:
                words = f"{type(fault).__name__}: {fault}"
                yield [Row(name, "", "", "", "nothing", words, words, None, "", (0.0, 0.0))]
                continue
            yield list(compare(subject, name, seconds))


def cells(row: Row) -> tuple[str, ...]:
    """The cells of one line of the table."""
    shown = "–" if row.difference is None else f"{row.difference:.1e} {row.variable}"
    ours, theirs = (words or "ran" for words in (row.ours, row.fmpy))
    ours += f" with --no-validate; else: {row.refused}" if row.refused else ""
    times = (f"{s:.2f}" if s else "–" for s in row.seconds)
    return (row.name, row.exporter, row.version, row.kind, ours, theirs, shown, *times)


def summary(rows: Sequence[Row]) -> str:
    """Counts: of FMUs, of interface types by exporter and verdict."""
    runnable = {row.name for row in rows if row.holds != "nothing"}
    counts = {
        "FMUs": len({row.name for row in rows}), "can run here": len(runnable),
        "ran in the harness": len({r.name for r in rows if not r.ours}),
        "of them with --no-validate": len({r.name for r in rows if not r.ours and r.refused}),
        "ran in FMPy": len({r.name for r in rows if not r.fmpy}),
    }  # fmt: skip
    verdicts = ("agree", "differ", "ours alone", "FMPy alone", "neither", "no binary")
    by_tool: dict[str, Counter[str]] = {}
    for row in rows:
        by_tool.setdefault(tool(row.exporter), Counter())[row.verdict] += 1
    lines = [(n, *(str(c[v]) for v in verdicts)) for n, c in sorted(by_tool.items())]
    total = sum(by_tool.values(), Counter())
    lines.append(("all", *(str(total[v]) for v in verdicts)))
    said = ", ".join(f"{name}: {count}" for name, count in counts.items())
    return f"{said}\n\n{markdown(('exporter', *verdicts), lines)}"


def tool(exporter: str) -> str:
    """The exporter without its version."""
    words = exporter.replace("_", " ").split() or ["not readable"]
    if words[0] in ("C++", "ghorwin/FMICodeGenerator@github", "FMICodeGenerator"):
        return "FMICodeGenerator"
    return words[0].rstrip("0123456789.") or words[0]


def main() -> int:
    """Run all, print the table, and return 1 where FMPy alone ran or the sides differ."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--timeout", type=float, default=60.0, help="of one side of one run, s")
    parser.add_argument("--select", default="", help="FMUs with this text in their path only")
    parser.add_argument("--json", type=Path, help="write the rows, after each FMU")
    parser.add_argument("--markdown", type=Path, help="write the table")
    given = parser.parse_args()
    rows: list[Row] = []
    for found in compare_all(given.folders, given.select, given.timeout):
        rows += found
        for row in found:
            print(f"{row.verdict:12} {' | '.join(cells(row))}", flush=True)
        write_rows(given.json, [{**asdict(row), "verdict": row.verdict} for row in rows])
    table = f"{markdown(HEAD, map(cells, rows))}\n{summary(rows)}"
    if given.markdown:
        given.markdown.write_text(table, encoding="utf-8")
    print(f"\n{summary(rows)}")
    return int(any(row.verdict in ("differ", "FMPy alone") for row in rows))


if __name__ == "__main__":
    raise SystemExit(main())
