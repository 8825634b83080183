"""What was measured, as the page of the documentation, its pictures, and JSON."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from benchmarks.foreign import markdown
from benchmarks.frame import Aim, Comparison, Found, middle, number
from benchmarks.measuring import machine

BEGIN = "<!-- what follows is written by `python -m benchmarks --page` -->"
END = "<!-- end of what is written by `python -m benchmarks --page` -->"


def text(found: Sequence[Found], rounds: int, pictures: str = "") -> str:
    """Date and machine, the aims, and a table for each comparison; `pictures` is the folder that
    holds theirs, "" where there are none."""
    date = datetime.now(UTC).date().isoformat()
    parts = ["; ".join([date, *machine().values(), f"{rounds} rounds"]) + "."]
    parts += ["Cells are medians, with the smallest and the largest in brackets."]
    aims = [(one, aim) for one in found for aim in one.comparison.aims]
    if aims:
        head = ("what", "aim", "found", "")
        parts += ["### Aims", markdown(head, [judged(one, aim) for one, aim in aims])]
    for one in found:
        parts += [f"### {one.comparison.title}", *filter(None, [one.comparison.note])]
        parts.append(table(one))
        if pictures and drawn(one):
            named = f"{one.comparison.title}: {one.comparison.unit} by side"
            parts.append(f"![{named}]({pictures}/{one.comparison.name}.png)")
    return "\n\n".join(part.strip() for part in parts) + "\n"


def judged(found: Found, aim: Aim) -> tuple[str, str, str, str]:
    """The line of an aim: met, or what is in the way."""
    figures = found.figures(aim)
    unit = "" if aim.against and not aim.above else f" {found.comparison.unit}"
    of = f" {'above' if aim.above else 'times'} {aim.against}" if aim.against else ""
    met = bool(figures) and statistics.median(figures) <= aim.bound
    words = "met" if met else aim.limit
    if not figures:
        words = found.refused.get(aim.side) or found.refused.get(aim.against, "not measured")
    return aim.row, f"at most {aim.bound:g}{unit}{of}", f"{middle(figures)}{unit}", words


def table(found: Found) -> str:
    """A line for each side; what refused says why."""
    one = found.comparison
    head = (one.axis or "side", one.unit, *([f"times {one.baseline}"] if one.baseline else []))
    lines = []
    for name in one.sides:
        if name in found.refused:
            lines.append((name, f"no: {found.refused[name]}", *([""] if one.baseline else [])))
            continue
        against = one.baseline and one.baseline not in found.refused
        ratio = middle(found.ratios(name, one.baseline)) if against else ""
        lines.append((name, middle(found.values(name)), *([ratio] if one.baseline else [])))
    return markdown(head, lines)


def drawn(found: Found) -> bool:
    """Whether there is something to draw."""
    return len(found.comparison.sides) - len(found.refused) > 1


def picture(found: Found, path: Path) -> None:
    """Medians with their spread, logarithmic: bars by side, or a line over sizes."""
    from matplotlib.figure import Figure

    one = found.comparison
    names = [name for name in one.sides if name not in found.refused]
    values = [found.values(name) for name in names]
    medians = [statistics.median(v) for v in values]
    spread = [
        [m - min(v) for m, v in zip(medians, values, strict=True)],
        [max(v) - m for m, v in zip(medians, values, strict=True)],
    ]
    height = 3.2 if one.sizes else 0.9 + 0.34 * len(names)
    figure = Figure(figsize=(7.2, height), layout="constrained")
    axes = figure.subplots()
    if one.sizes:
        sizes = [s for s, name in zip(one.sizes, one.sides, strict=True) if name in names]
        axes.errorbar(sizes, medians, yerr=spread, marker="o", capsize=3, color="C1")
        axes.set(xscale="log", yscale="log", xlabel=one.axis, ylabel=one.unit)
        axes.set_ylim(min(map(min, values)) / 2.0, 2.0 * max(map(max, values)))
    else:
        places = range(len(names))[::-1]
        for place, name, median, below, above in zip(places, names, medians, *spread, strict=True):
            colour = "C1" if "ours" in name else "C0"
            span = [[below], [above]]
            axes.errorbar(median, place, xerr=span, fmt="o", capsize=3, color=colour)
            axes.annotate(
                number(median), (median, place), (0, 5), textcoords="offset points",
                ha="center", fontsize=7,
            )  # fmt: skip
        axes.set_yticks(places, names)
        axes.set_xlabel(one.unit)
        if min(map(min, values)) > 0.0:  # a difference of two times may be below 0
            axes.set_xscale("log")
            axes.set_xlim(min(map(min, values)) / 2.0, 2.0 * max(map(max, values)))
        axes.set_ylim(-0.6, len(names) - 0.2)
    axes.set_title(one.title, fontsize=10)
    axes.grid(alpha=0.3, which="major")
    figure.savefig(path, dpi=110)


def write_page(page: Path, found: Sequence[Found], rounds: int) -> None:
    """Replace what the page holds between the two marks, and the pictures beside it."""
    before, begin, rest = page.read_text(encoding="utf-8").partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise SystemExit(f"{page} lacks the line {END if begin else BEGIN}")
    folder = page.with_suffix("")
    write_pictures(folder, found)
    made = text(found, rounds, folder.name)
    page.write_text(f"{before}{BEGIN}\n\n{made}\n{END}{after}", encoding="utf-8")


def write_pictures(folder: Path, found: Sequence[Found]) -> None:
    """A PNG for each comparison."""
    folder.mkdir(parents=True, exist_ok=True)
    for one in filter(drawn, found):
        picture(one, folder / f"{one.comparison.name}.png")


def plain(found: Sequence[Found]) -> list[dict[str, Any]]:
    """All numbers, for the JSON file."""
    return [
        {"name": one.comparison.name, "unit": one.comparison.unit, "rounds": one.rounds,
         "refused": one.refused}
        for one in found
    ]  # fmt: skip


__all__ = ["Comparison", "picture", "plain", "text", "write_page", "write_pictures"]
