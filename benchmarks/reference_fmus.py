"""The Reference FMUs against their published outputs and against exact solutions.

    python -m benchmarks.reference_fmus FOLDER [FOLDER …] [--json FILE] [--plot FILE]

FOLDER is searched for `.fmu` files and for `{Model}_out.csv` and `{Model}_in.csv`; build the FMUs
from the public sources of the Modelica Association first, in as many versions as you like. The
published outputs were made by Euler's method inside the FMUs. So each FMU is run

- in co-simulation, without and (FMI 3) with event mode, against the published output, in every way
  that `tests.every_way` knows;
- in scheduled execution against the schedule that its description states;
- in model exchange by Euler's method with the same fixed step, against the published output;
- in model exchange by CVODE at a relative tolerance of 1e-8, against the exact solution.

The difference is the largest one at equal times, as a share of the range of the variable; where an
event repeats a time the last row counts. Rows beyond the last common time are left out.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table
from scipy.integrate import solve_ivp

from harness import Fmu, simulate
from harness.results.csv_files import read_reference
from harness.results.result import Result
from tests.every_way.cases import Case
from tests.every_way.reference_fmus import reference_cases
from tests.every_way.ways import WAYS, WIRED, by_plain_driver

Array = NDArray[np.float64]
FIXED_STEP = {
    "BouncingBall": 1e-3, "Dahlquist": 0.1, "Stair": 0.2, "VanDerPol": 1e-2, "StateSpace": 1e-3,
    "Feedthrough": 0.1, "Resource": 1.0,
}  # fmt: skip
"""The step (s) of the method inside each FMU."""
GRID = {
    "BouncingBall": (3.0, 0.01), "Dahlquist": (10.0, 0.1), "Stair": (10.0, 0.2),
    "VanDerPol": (20.0, 0.01), "StateSpace": (10.0, 1.0), "Feedthrough": (2.0, 0.1),
    "Resource": (1.0, 1.0),
}  # fmt: skip
"""Stop time and distance of rows (s) of the published outputs."""
SCHEDULE = {
    "inClock1Ticks": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10],
    "inClock2Ticks": [1, 2, 2, 2, 2, 2, 2, 2, 3, 4],
    "inClock3Ticks": [0, 0, 0, 0, 1, 1, 1, 1, 1, 1],
    "totalInClockTicks": [2, 4, 5, 6, 8, 9, 10, 11, 13, 15],
    "output3": [0, 0, 0, 0, 1000, 1000, 1000, 1000, 1000, 1000],
}
"""Of Clocks, after each second from 0 on."""
BEHIND = SCHEDULE | {
    "inClock2Ticks": [0, 1, 2, 2, 2, 2, 2, 2, 2, 3],
    "totalInClockTicks": [1, 3, 5, 6, 8, 9, 10, 11, 12, 14],
}
"""The same where a wire triggers inClock2, which acts behind the row of its instant."""


@dataclass(frozen=True)
class Row:
    """One run: `difference` as a share of the range."""

    model: str
    fmi: str
    kind: str
    method: str
    compared_with: str
    columns: int
    rows: int
    difference: float
    limit: float

    @property
    def agrees(self) -> bool:
        """Whether the difference is within its limit."""
        return self.difference <= self.limit


def run_all(folders: list[Path]) -> Iterator[Row]:
    """A row for each FMU below `folders`, kind and method."""
    for path in _fmus(folders):
        yield from run_fmu(path, folders)
    for case in reference_cases(folders):
        if case.exact:
            yield from run_every_way(case, folders)


def run_every_way(case: Case, folders: list[Path]) -> Iterator[Row]:
    """The runs of one case in all ways: that of the plain driver, and those of the harness."""
    name, against = case.model.name, "published output"
    expected: Mapping[str, Sequence[Any]]
    if case.kind == "scheduled-execution":
        expected, against = SCHEDULE, "its schedule"
    else:
        expected = read_reference(_find(folders, f"{name}_out.csv"), {}).columns
    columns = [column for column in case.watched if column in expected]
    for way, run in {"plain driver": by_plain_driver, **WAYS}.items():
        method = f"{way}, event mode" if case.event_mode else way
        rows = run(case)
        if case.kind == "scheduled-execution":
            expected = BEHIND if way in WIRED else SCHEDULE
        difference = max(_apart(rows[c], expected[c]) for c in columns)
        count = case.job().steps + 1
        yield Row(name, f"{case.version}.0", case.kind, method, against, len(columns), count,
                  difference, 1e-9)  # fmt: skip


def _apart(ours: Sequence[Any], theirs: Sequence[Any]) -> float:
    """The largest difference of the rows that there are, as a share of the range; 1 for texts."""
    pairs = [(a, b) for a, b in zip(ours, theirs, strict=False) if a is not None]
    if isinstance(pairs[0][0], str | bytes):
        texts = [(a.hex() if isinstance(a, bytes) else a, b) for a, b in pairs]
        return float(any(a != b for a, b in texts))
    words = {"true": 1.0, "false": 0.0}
    given = [[words.get(w, w) for w in str(b).split()] for _, b in pairs]
    return _share(np.array([np.ravel(a) for a, _ in pairs], float), np.array(given, float))


def _fmus(folders: list[Path]) -> list[Path]:
    return sorted(path for folder in folders for path in folder.rglob("*.fmu"))


def _exchanges(path: Path) -> bool:
    with Fmu(path) as fmu:
        return fmu.description.model_exchange is not None


def run_fmu(path: Path, folders: list[Path]) -> Iterator[Row]:
    """The runs of one FMU."""
    with Fmu(path) as fmu:
        d = fmu.description
    model, fmi = path.stem, d.fmi_version[:3]
    if model not in GRID:
        return
    published = _find(folders, f"{model}_out.csv")
    if d.co_simulation is not None:
        for event_mode in (False, True) if d.co_simulation.has_event_mode else (False,):
            method = "event mode" if event_mode else "step by step"
            yield _against_file(path, fmi, method, published, interface_type="cs",
                                step_size=GRID[model][1], event_mode=event_mode)  # fmt: skip
            if model == "Feedthrough":
                yield _inputs(path, fmi, method, _find(folders, "Feedthrough_in.csv"), event_mode)
    if d.model_exchange is not None:
        yield _against_file(path, fmi, "Euler", published, interface_type="me", solver="euler",
                            step_size=FIXED_STEP[model])  # fmt: skip
        if model in SOLUTIONS:
            yield _against_solution(path, fmi)


def _against_file(path: Path, fmi: str, method: str, published: Path, **options: object) -> Row:
    stop, interval = GRID[path.stem]
    result = simulate(path, stop_time=stop, output_interval=interval, **options)  # type: ignore[arg-type]
    shapes: dict[str, tuple[int, ...]] = {"y": (3,)} if path.stem == "StateSpace" else {}
    reference = read_reference(published, shapes)
    columns = [name for name in reference.columns if name in result]
    ours, theirs = _common(result, reference.time)
    worst = 0.0
    for name in columns:
        numbers = reference.numbers(name)
        if result.column(name).dtype is None or numbers is None:
            same = list(result[name][ours]) == [reference.columns[name][i] for i in theirs]
            worst = max(worst, 0.0 if same else 1.0)
        else:
            worst = max(worst, _share(result[name][ours], numbers[theirs]))
    kind = result.manifest.experiment["interface_type"]
    return Row(
        path.stem, fmi, kind, method, "published output", len(columns), len(ours), worst, 1e-9
    )


def _common(result: Result, times: Array) -> tuple[list[int], list[int]]:
    """The rows of both at equal times, the last row where a time repeats."""
    last = {round(float(t), 9): i for i, t in enumerate(result.time)}
    pairs = [(last[key], i) for i, t in enumerate(times) if (key := round(float(t), 9)) in last]
    return [a for a, _ in pairs], [b for _, b in pairs]


def _share(ours: Array, theirs: Array) -> float:
    spread = float(np.ptp(theirs)) or float(np.abs(theirs).max()) or 1.0
    return float(np.abs(np.asarray(ours, dtype=np.float64) - theirs).max() / spread)


def _inputs(path: Path, fmi: str, method: str, table: Path, event_mode: bool) -> Row:
    """What goes in comes out: the published inputs, exact to the last integer."""
    result = simulate(path, inputs=table, stop_time=2.0, step_size=0.1, event_mode=event_mode)
    given = read_reference(table, {})
    names = [n for n in given.columns if n.replace("_input", "_output") in result]
    wrong = sum(
        int(result[name.replace("_input", "_output")][row]) != int(given.columns[name][at])
        for name in names
        for row, at in ((0, 0), (-1, -1))
    )
    return Row("Feedthrough", fmi, "co-simulation", method, "published input", len(names), 2,
               float(wrong), 0.0)  # fmt: skip


def _against_solution(path: Path, fmi: str) -> Row:
    stop, interval = GRID[path.stem]
    result = simulate(path, interface_type="me", stop_time=stop, output_interval=interval,
                      relative_tolerance=1e-8)  # fmt: skip
    keep = np.append(np.diff(result.time) > 0.0, True)  # after an event
    exact = SOLUTIONS[path.stem](result.time[keep])
    worst = max(_share(result[name][keep], values) for name, values in exact.items())
    return Row(path.stem, fmi, "model-exchange", "CVODE", "exact solution", len(exact),
               int(keep.sum()), worst, 1e-5)  # fmt: skip


def _ball(time: Array) -> dict[str, Array]:
    """h of the ball with g = 9.81 m/s² and e = 0.7, which rests below 0.1 m/s."""
    found = np.zeros(len(time))
    begin, speed, height = 0.0, 0.0, 1.0
    while True:
        flight = (speed + math.sqrt(speed**2 + 19.62 * height)) / 9.81
        inside = (time >= begin) & (time <= begin + flight)
        t = time[inside] - begin
        found[inside] = height + speed * t - 4.905 * t**2
        begin, speed, height = begin + flight, 0.7 * (9.81 * flight - speed), 0.0
        if speed < 0.1:
            return {"h": found}


def _oscillator(time: Array) -> dict[str, Array]:
    """The van der Pol oscillator with mu = 1 by DOP853 at 1e-12."""
    solution = solve_ivp(
        lambda _, x: [x[1], (1.0 - x[0] ** 2) * x[1] - x[0]],
        (0.0, float(time[-1])), [2.0, 0.0], "DOP853", time, rtol=1e-12, atol=1e-12,
    )  # fmt: skip
    return {"x0": solution.y[0], "x1": solution.y[1]}


SOLUTIONS: dict[str, Callable[[Array], dict[str, Array]]] = {
    "BouncingBall": _ball,
    "VanDerPol": _oscillator,
    "Dahlquist": lambda t: {"x": np.exp(-t)},
    "StateSpace": lambda t: {f"y[{i}]": i * np.exp(t) for i in (1, 2, 3)},
    "Stair": lambda t: {"counter": np.floor(t + 1e-9) + 1.0},
}


def _find(folders: list[Path], name: str) -> Path:
    found = next((path for folder in folders for path in sorted(folder.rglob(name))), None)
    if found is None:
        raise SystemExit(f"{name} was not found below {', '.join(map(str, folders))}")
    return found


def table(rows: list[Row]) -> Table:
    """The rows as a table."""
    made = Table(box=SIMPLE)
    for title in (
        "model",
        "FMI",
        "kind",
        "method",
        "against",
        "variables × rows",
        "difference",
        "",
    ):
        made.add_column(title)
    for row in rows:
        made.add_row(*cells(row))
    return made


def cells(row: Row) -> tuple[str, ...]:
    """The cells of one row of the table."""
    size = f"{row.columns} × {row.rows}" if row.columns else "–"
    shown = f"{row.difference:.1e}" if row.difference else "0"
    verdict = "agrees" if row.agrees else "DIFFERS"
    return (row.model, row.fmi, row.kind, row.method, row.compared_with, size, shown, verdict)


def draw(folders: list[Path], target: Path) -> None:
    """The bouncing ball in model exchange, and its published output."""
    from harness.results.plots import legend, line_style, panels

    fmu = next(path for path in _fmus(folders) if path.stem == "BouncingBall" and _exchanges(path))
    result = simulate(fmu, interface_type="me", stop_time=3.0, output_interval=0.01)
    reference = read_reference(_find(folders, "BouncingBall_out.csv"), {})
    figure, axes = panels(
        2, "BouncingBall, model exchange: both sides of every bounce are recorded"
    )
    for axis, (name, unit) in zip(axes, (("h", "m"), ("v", "m/s")), strict=True):
        axis.plot(result.time, result[name], label="CVODE", **line_style(0))
        numbers = reference.numbers(name)
        assert numbers is not None
        axis.plot(reference.time, numbers, label="published (Euler, 1 ms)", **line_style(1))
        axis.set_ylabel(f"{name} ({unit})")
    legend(axes[0])
    figure.align_ylabels()
    figure.savefig(target)


def main() -> int:
    """Run, print the table, and return 1 where something differs."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--json", type=Path, help="write the rows")
    parser.add_argument("--markdown", type=Path, help="write the table")
    parser.add_argument("--plot", type=Path, help="draw the bouncing ball")
    given = parser.parse_args()
    rows = list(run_all(given.folders))
    Console(width=150).print(table(rows))
    if given.json:
        given.json.write_text(json.dumps([asdict(row) for row in rows], indent=2) + "\n")
    if given.markdown:
        head = "| model | FMI | kind | method | against | variables × rows | difference | |\n"
        lines = ["| " + " | ".join(cells(row)) + " |\n" for row in rows]
        given.markdown.write_text(head + "|---" * 8 + "|\n" + "".join(lines))
    if given.plot:
        draw(given.folders, given.plot)
    return int(not all(row.agrees for row in rows))


if __name__ == "__main__":
    raise SystemExit(main())
