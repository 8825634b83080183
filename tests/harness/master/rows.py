"""Runs systems of mocks and keeps the rows."""

from collections.abc import Mapping

import numpy as np

from harness.errors import HarnessError
from harness.master.program.layout import make_layout
from harness.master.run import Outcome, execute, plan_system
from harness.system.graph import System
from tests.harness.master.mock import MockFmu


class Rows:
    """A recorder: `seconds` (n,), the same as whole `times` in ns, and rows (n, columns)."""

    def __init__(self, columns: tuple[str, ...], cells: tuple[str, ...] = ()) -> None:
        self.columns, self.cells = columns, cells
        self.chunks: list[tuple[np.ndarray, np.ndarray]] = []

    def add_texts(self, new: list[str | bytes]) -> None:
        self.texts = [*getattr(self, "texts", []), *new]

    def append(self, times: np.ndarray, rows: np.ndarray) -> None:
        kept = rows.copy()
        for i, cell in enumerate(self.cells):
            if cell in ("int64", "uint64"):
                kept[:, i] = np.ascontiguousarray(rows[:, i]).view(cell)
        self.chunks.append((times.copy(), kept))

    @property
    def times(self) -> np.ndarray:
        return np.rint(self.seconds * 1e9).astype(np.int64)

    @property
    def seconds(self) -> np.ndarray:
        return np.concatenate([np.empty(0), *(c[0] for c in self.chunks)])

    @property
    def rows(self) -> np.ndarray:
        return np.concatenate([np.empty((0, len(self.columns))), *(c[1] for c in self.chunks)])

    def __getitem__(self, name: str) -> np.ndarray:
        return self.rows[:, self.columns.index(name)]


def run_to_end(
    system: System, fmus: Mapping[str, MockFmu], record: tuple[str, ...] = ("*",)
) -> tuple[Rows, Outcome]:
    """All that a run gives, whatever ends it."""
    plan = plan_system(system, fmus, record)  # type: ignore[arg-type]
    layout = make_layout(plan, {name: fmu.description for name, fmu in fmus.items()})
    cells = tuple(layout.cell(end) for end in plan.recorded)
    rows = Rows(tuple(map(str, plan.recorded)), cells)
    return rows, execute(plan, fmus, rows)  # type: ignore[arg-type]


def run(system: System, fmus: Mapping[str, MockFmu], record: tuple[str, ...] = ("*",)) -> Rows:
    """The rows of a run that reaches its stop time."""
    rows, outcome = run_to_end(system, fmus, record)
    if isinstance(outcome.fault, HarnessError):
        raise outcome.fault
    return rows
