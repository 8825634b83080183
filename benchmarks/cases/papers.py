"""`reproduce --fast`, paper by paper: minutes, so in few rounds."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from benchmarks.cases.commands import seconds
from benchmarks.frame import Aim, Comparison, Setting, Side

PAPERS = ("ahn2009", "barragan", "raheem2013", "serkies2013", "takata")
LIMIT = (
    "The runs of its experiments, one after the other; fewer in the fast subset, or a faster one."
)


def comparisons(setting: Setting) -> Iterator[Comparison]:
    """Each paper's fast subset, everything cached."""
    sides = {}
    for paper in PAPERS:
        output = str(setting.folder / f"paper_{paper}")
        asked = ("reproduce", paper, "--fast", "--output", output)
        sides[paper] = Side(partial(seconds, *asked), rounds=1)
    aims = tuple(Aim(f"`reproduce {name} --fast`", name, 20.0, LIMIT) for name in sides)
    yield Comparison("papers", "`reproduce --fast`, each paper", "s", sides, aims=aims)
