"""Every export of the project in other tools, its trajectory against our own loop.

    python -m benchmarks.exports_elsewhere [--fmusim FILE] [--fmucheck FILE] [--select TEXT]
        [--json FILE] [--markdown FILE]

Exports are all registered plants, all controllers and estimators as an experiment configures them,
and the signals of an experiment, native and portable, FMI 2 and 3; native plants also as equations
(model exchange), which the tool's own solver integrates. A tool is tried where its package is
installed or its path is given: fmusim is a program of Reference-FMUs (until their commit 7b3fc08),
fmuCheck that of FMUComplianceChecker, built with FMI Library. Each export runs in each tool in a
process of its own within a time limit.

The inputs are those of the export's certificate, for equations its last row throughout: fmusim's
solver takes no others. What is compared are the outputs after each step of the tool and of our own
loop; a cell holds the largest difference as a share of its range, or the words of a refusal.
"""

from __future__ import annotations

import argparse
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.foreign import AGREES, markdown, write_rows
from harness.export.certificate import Certificate, read_certificate
from harness.export.verify import replay
from harness.fmi.fmu import Fmu
from tests.peers.order import Order, RefusedError, run_in
from tests.peers.replays import controllers, plants, signals
from tests.peers.tools import SOLVERS, TOOLS, installed

PROGRAMS = {"fmusim": "fmusim", "fmucheck": "fmuCheck"}
"""Tools that are programs, by the name of their driver."""
EULER = 1e-2
"""What is allowed to fmuCheck, which solves equations by forward Euler; to other solvers `AGREES`,
to co-simulation the tolerance of the certificate."""


@dataclass(frozen=True)
class Export:
    """An FMU and the way in which it is run."""

    path: Path
    group: str
    interface: str = "co-simulation"


@dataclass(frozen=True)
class Row:
    """An export in a tool: `difference` is None where the tool refused, in its `words`."""

    group: str
    name: str
    tool: str
    difference: float | None
    allowed: float
    words: str = ""

    @property
    def agrees(self) -> bool:
        """Whether there is a trajectory, and as near to ours as its solver allows."""
        return self.difference is not None and self.difference <= self.allowed


def exports() -> Iterator[Export]:
    """All, built where they are not in the cache."""
    for title, make in (("plant", plants), ("controller", controllers), ("signal", signals)):
        for kind in ("native", "portable"):
            for fmi in (2, 3):
                for path in make(fmi, kind == "portable"):
                    yield Export(path, f"{title}, {kind} FMI {fmi}")
                    if title == "plant" and kind == "native":
                        group = f"equations of a plant, FMI {fmi}"
                        yield Export(path, group, "model-exchange")


def tried(export: Export, tools: Mapping[str, str]) -> Iterator[Row]:
    """The export in each tool (its program by the name of its driver, "" where it has none)."""
    with Fmu(export.path) as fmu:
        made = read_certificate(fmu)
    near = made.tolerance
    if export.interface == "model-exchange":
        constant = {name: column[-1:] * made.rows for name, column in made.inputs.items()}
        made, near = replace(made, inputs=constant), AGREES
    expected = replay(export.path, made.step, made.rows, made.inputs, tuple(made.outputs))
    for tool, program in tools.items():
        asked = order(export, made, program)
        found, words = None, ""
        try:
            if export.interface == "model-exchange" and tool not in SOLVERS:
                raise RefusedError("co-simulation only")
            found = apart(expected, run_in(tool, asked))
        except RefusedError as refusal:
            words = str(refusal).replace(str(export.path), "…")
        except subprocess.TimeoutExpired as late:
            words = f"did not end within {late.timeout:g} s"
        euler = tool == "fmucheck" and export.interface == "model-exchange"
        allowed = EULER if euler else near
        yield Row(export.group, export.path.stem, tool, found, allowed, words)


def order(export: Export, made: Certificate, program: str) -> Order:
    """What the certificate's inputs demand of a tool."""
    return Order(
        fmus={"it": str(export.path)},
        step=made.step,
        steps=made.rows,
        outputs=[f"it.{name}" for name in made.outputs],
        inputs={f"it.{name}": list(column) for name, column in made.inputs.items()},
        program=program,
        interface=export.interface,
    )


def apart(ours: NDArray[np.float64], theirs: NDArray[np.float64]) -> float:
    """The largest difference of a column as a share of its range, which counts as a millionth of
    its size at least (as 1 where it is 0): fmusim writes 16 digits."""
    spread = np.maximum(np.ptp(ours, axis=0), 1e-6 * np.abs(ours).max(axis=0))
    gap = np.abs(theirs - ours).max(axis=0) / np.where(spread > 0, spread, 1.0)
    return float(gap.max()) if np.isfinite(gap).all() else float("inf")


def cell(rows: Sequence[Row]) -> str:
    """What a tool made of a group: its worst export, and each kind of refusal."""
    found = [row.difference for row in rows if row.difference is not None]
    said = []
    if found:
        count = "" if len(found) == len(rows) else f"{len(found)} of {len(rows)}: "
        said.append(count + (f"{max(found):.0e}" if max(found) else "bit-equal"))
    refusals = dict.fromkeys(row.words.splitlines()[-1][:120] for row in rows if row.words)
    return "; ".join([*said, *refusals])


def table(rows: Sequence[Row], tools: Sequence[str]) -> str:
    """A line for each group of exports."""
    lines = []
    for group in dict.fromkeys(row.group for row in rows):
        ours = [[row for row in rows if (row.group, row.tool) == (group, tool)] for tool in tools]
        lines.append((f"{len(ours[0])} × {group}", *map(cell, ours)))
    return markdown(("exports", *map(title, tools)), lines)


def title(tool: str) -> str:
    """The tool with its version, where it is a package."""
    return PROGRAMS.get(tool) or f"{TOOLS[tool]} {version(TOOLS[tool])}"


def main() -> int:
    """Try all, print the table, and return 1 where a trajectory differs."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    for driver, name in PROGRAMS.items():
        parser.add_argument(f"--{driver}", metavar="FILE", help=f"the path of {name}")
    parser.add_argument("--select", default="", help="exports with this text in group or name")
    parser.add_argument("--json", type=Path, help="write the rows, after each export")
    parser.add_argument("--markdown", type=Path, help="write the table")
    given = parser.parse_args()
    tools = {tool: "" for tool in TOOLS if installed(tool)}
    tools |= {driver: path for driver in PROGRAMS if (path := getattr(given, driver))}
    rows: list[Row] = []
    for export in exports():
        if given.select not in f"{export.group}: {export.path.stem}":
            continue
        for row in tried(export, tools):
            rows.append(row)
            shown = f"{row.difference:.1e}" if row.difference is not None else row.words[-300:]
            print(f"{row.group} | {row.name} | {row.tool} | {shown}", flush=True)
        write_rows(given.json, [asdict(row) for row in rows])
    made = table(rows, list(tools))
    print(f"\n{made}")
    if given.markdown:
        given.markdown.write_text(made, encoding="utf-8")
    return int(any(row.difference is not None and not row.agrees for row in rows))


if __name__ == "__main__":
    raise SystemExit(main())
