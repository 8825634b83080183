"""Our loops in other tools, as a table in Markdown, measured anew:

    python -m tests.peers.table

It takes some minutes, more where FMUs are yet to be built. A cell says how far the tool's numbers
are from ours, and by how many samples the loop there is later than ours: the delay on the wire
from the controller to the plant with which ours comes nearest. Single FMUs:
`benchmarks.exports_elsewhere`.
"""

from __future__ import annotations

import sys
import tempfile
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.peers import loops, ssp_loops
from tests.peers.order import run_in
from tests.peers.tools import MASTERS, installed

Rows = NDArray[np.float64]

STOP_TIME, SAMPLE_TIME = 2.0, 0.01
DELAYS = (0, 1, 2)
REFUSED = {
    "libcosim": (3, "no: libcosim knows no FMI 3"),
    "ecos as a package": (3, "no: FMI 3 needs SSP 2.0, Ecos reads 1.0"),
    "fmpy as a package": (3, "no: FMPy's function runs FMI 1 and 2"),
}


@dataclass(frozen=True)
class Line:
    """A row of the table: what is tried, and how a tool's cell is found."""

    title: str
    cell: Callable[[str], str]


def difference(largest: float) -> str:
    """How a relative difference is shown."""
    return "bit-equal" if largest == 0.0 else f"{largest:.0e} of the largest value"


def off(found: Rows, expected: Rows) -> float:
    """The largest difference of a column, relative to its largest value."""
    return float(np.max(np.abs(found - expected).max(axis=0) / np.abs(expected).max(axis=0)))


def refused(tool: str, fmi: int) -> str | None:
    """Why a tool does not do this at all."""
    above, sentence = REFUSED.get(tool, (9, ""))
    return sentence if fmi >= above else None


def judged(found: Rows, ours: Callable[[int], Rows]) -> str:
    """The nearest of our loops, by its delay in samples."""
    gaps = {samples: off(found, ours(samples)) for samples in DELAYS}
    best = min(gaps, key=lambda samples: gaps[samples])
    return f"{difference(gaps[best])}, {best} sample{'s' if best != 1 else ''} later"


def wired(name: str, fmi: int, portable: bool, tool: str) -> str:
    """The loop of plant and controller that is wired by a tool's own interface."""
    why = refused(tool, fmi)
    if why:
        return why
    asked = loops.order(name, fmi, portable=portable, controller_first=tool == "fmpy")
    return judged(run_in(tool, asked), lambda k: loops.ours(name, fmi, k * loops.STEP))


@cache
def package(variant: str, fmi: int, portable: bool, folder: Path) -> Path:
    one = ssp_loops.experiment(fmi, STOP_TIME, portable=portable)
    return ssp_loops.exported(one, variant, folder)


def packed(folder: Path, variant: str, fmi: int, portable: bool, tool: str) -> str:
    """The lead experiment as an .ssp, 10 ms."""
    why = refused(f"{tool} as a package", fmi) or refused(tool, fmi)
    if why:
        return why
    path = package(variant, fmi, portable, folder)
    found = ssp_loops.theirs(tool, path, SAMPLE_TIME, round(STOP_TIME / SAMPLE_TIME))

    def ours(samples: int) -> Rows:
        one = ssp_loops.experiment(fmi, STOP_TIME, delay=samples * SAMPLE_TIME)
        return ssp_loops.ours(one, variant)

    return judged(found, ours)


def lines(folder: Path) -> Iterable[Line]:
    """The rows of the table."""
    kinds = [(fmi, portable) for portable in (False, True) for fmi in (2, 3)]
    for fmi, portable in kinds:
        kind = "portable" if portable else "native"
        yield Line(f"loop, {kind} FMI {fmi}, wired by API", partial(wired, "pid", fmi, portable))
    for variant, fmi, portable in (
        ("pid", 2, False), ("pid", 2, True), ("robust_ekf", 2, False), ("pid", 3, False),
    ):  # fmt: skip
        kind = "portable" if portable else "native"
        title = f"lead experiment ({variant}), {kind} FMI {fmi}, as .ssp"
        yield Line(title, partial(packed, folder, variant, fmi, portable))


def main() -> None:
    """Print the table for the tools that are installed."""
    warnings.simplefilter("ignore")
    tools = [tool for tool in MASTERS if installed(tool)]
    heads = [f"{MASTERS[tool]} {version(MASTERS[tool])}" for tool in tools]
    print("| | " + " | ".join(heads) + " |")
    print("| --- |" + " --- |" * len(tools), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for line in lines(Path(folder)):
            cells = [line.cell(tool) for tool in tools]
            print(f"| {line.title} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
