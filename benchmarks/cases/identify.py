"""Learning a fuzzy model from rows: ours compiled, in plain Python, and a filter in numpy."""

from __future__ import annotations

from collections.abc import Iterator

from benchmarks import identification as module
from benchmarks.frame import Aim, Comparison, Setting, Side

SETS, ROWS = 7, 60


def comparisons(setting: Setting) -> Iterator[Comparison]:
    """A Takagi–Sugeno model of two inputs with `SETS`² rules."""
    sides = {name: Side(run) for name, run in module.sides_of(SETS, ROWS).items()}
    aim = Aim(
        "`identify`, a row", module.COMPILED, 2.0,
        "The filter's work grows with the square of the parameters adapted.",
    )  # fmt: skip
    title = "Identification of a fuzzy model, offline"
    yield Comparison("identification", title, "ms a row", sides, next(iter(sides)), (aim,))
