"""Other people's packages (SSP): ours, against results beside them and against Ecos.

    python -m benchmarks.foreign_packages FOLDER [FOLDER …] [--timeout S] [--stop-time S]
        [--compile] [--json FILE] [--markdown FILE] [--select TEXT]

FOLDER is searched for `.ssp` archives and for `.ssd` files, which stand for the unpacked package
around them. Each runs as `fmu-harness run` does, in a process of its own with a time limit, for at
most `--stop-time` seconds of simulated time after its start; where it is refused for a fault of a
description, a second time without validation. Ours is compared with a table `NAME_out.csv` or
`results.csv` beside it, columns named "component.variable", and, where ecospy is installed, with
Ecos at the same step (Jacobi, both).
"""

from __future__ import annotations

import argparse
import importlib.util
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from benchmarks.foreign import AGREES, Answer, ask, difference, markdown, write_rows

HEAD = ("package", "ours", "against results", "against Ecos", "s, ours", "s, Ecos")
BESIDE = ("{}_out.csv", "results.csv")
KINDS = {
    "has no library": "no library for this machine",
    "there is no file": "names files that are not there",
    "has no FMU": "holds no FMU",
    "did not end": "time limit",
}
"""Kinds of refusal by words of their sentence."""


@dataclass(frozen=True)
class Row:
    """One package; words are empty where a side ran, differences None where none was made."""

    name: str
    ours: str
    refused: str
    results: float | None
    ecos: str
    difference: float | None
    variable: str
    seconds: tuple[float, float]

    @property
    def kind(self) -> str:
        """How it went, for the counts."""
        if self.ours:
            return next((kind for words, kind in KINDS.items() if words in self.ours), "refused")
        differ = max(self.results or 0.0, self.difference or 0.0) > AGREES
        return "differs" if differ else "ran without validation" if self.refused else "ran"


def run(path: Path, name: str, options: dict[str, Any], seconds: float) -> Row:
    """Run one package on all sides."""
    task = {"path": str(path.resolve()), **options}
    ours, refused = ask("package", task, seconds), ""
    if "--no-validate" in ours.words:
        refused = ours.words
        ours = ask("package", {**task, "validate": False}, seconds)
    results = None
    beside = [path.with_name(form.format(path.stem)) for form in BESIDE]
    table = next((str(one.resolve()) for one in beside if one.is_file()), "")
    if ours.ran and table:
        given = ask("table", {"path": table}, seconds)
        results = difference(ours.columns, given.columns)[0] if given.ran else float("inf")
    ecos, apart, variable = Answer("not asked"), None, ""
    if ours.ran and importlib.util.find_spec("ecospy"):
        times, names = ours.columns["time"], [n for n in ours.columns if n != "time"]
        asked = {
            "path": task["path"],
            "compiled": options["compiled"],
            "times": times[:2].tolist(),
            "rows": len(times),
        }
        ecos = ask("ecos", {**asked, "names": names}, seconds)
        if ecos.ran:
            apart, variable = difference(ours.columns, ecos.columns)
    return Row(
        name, ours.words, refused, results, ecos.words, apart, variable,
        (ours.seconds, ecos.seconds),
    )  # fmt: skip


def run_all(
    folders: Sequence[Path], select: str, options: dict[str, Any], seconds: float
) -> Iterator[Row]:
    """The rows of all packages below the folders whose path holds the text `select`."""
    for folder in folders:
        for path in sorted(p for end in ("ssp", "ssd") for p in folder.rglob(f"*.{end}")):
            name = path.relative_to(folder).as_posix()
            if select in name and path.is_file():
                yield run(path, name, options, seconds)


def cells(row: Row) -> tuple[str, ...]:
    """The cells of one line of the table."""
    ours = row.ours or "ran" + (f" with --no-validate; else: {row.refused}" if row.refused else "")
    results = "–" if row.results is None else f"{row.results:.1e}"
    ecos = row.ecos if row.difference is None else f"{row.difference:.1e} {row.variable}"
    return (row.name, ours, results, ecos, *(f"{s:.2f}" if s else "–" for s in row.seconds))


def summary(rows: Sequence[Row]) -> str:
    """How many packages went which way."""
    counts = Counter(row.kind for row in rows)
    lines = [(kind, str(count)) for kind, count in counts.most_common()]
    return markdown(("packages", str(len(rows))), lines)


def main() -> int:
    """Run all, print the table, and return 1 where one differs."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--timeout", type=float, default=60.0, help="of one side of one run, s")
    parser.add_argument("--stop-time", type=float, default=10.0, help="longest run, s")
    parser.add_argument("--compile", action="store_true", help="build FMUs from their sources")
    parser.add_argument("--select", default="", help="packages with this text in their path only")
    parser.add_argument("--json", type=Path, help="write the rows, after each package")
    parser.add_argument("--markdown", type=Path, help="write the table")
    given = parser.parse_args()
    options = {"longest": given.stop_time, "compiled": given.compile}
    rows: list[Row] = []
    for row in run_all(given.folders, given.select, options, given.timeout):
        rows.append(row)
        print(f"{row.kind:30} {' | '.join(cells(row))}", flush=True)
        write_rows(given.json, [{**asdict(one), "kind": one.kind} for one in rows])
    if given.markdown:
        text = f"{markdown(HEAD, map(cells, rows))}\n{summary(rows)}"
        given.markdown.write_text(text, encoding="utf-8")
    print(f"\n{summary(rows)}")
    return int(any(row.kind == "differs" for row in rows))


if __name__ == "__main__":
    raise SystemExit(main())
