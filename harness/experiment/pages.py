"""The page of a paper: its verdicts, studies, regions and pictures, as HTML and in its README."""

from __future__ import annotations

import html
from collections.abc import Iterable, Iterator
from pathlib import Path

from harness.errors import RecordingError
from harness.experiment import verdict_text
from harness.experiment.experiment import Experiment
from harness.experiment.judging import ALPHA
from harness.experiment.reproduce import Reproduction
from harness.experiment.study import LOST, median
from harness.experiment.sweep import Region
from harness.experiment.verdict_plot import write_pictures
from harness.results.atomic import atomic_write, writing

VERDICTS, STUDIES, REGIONS = "verdicts", "studies", "regions"
"""Names of the parts of a paper's README that are filled from runs, between markers."""


def verdict_rows(reproduction: Reproduction) -> Iterator[tuple[str, ...]]:
    """Rows (page, claim, paper, ours, verdict, reason, command), the heading first."""
    yield "page", "claim", "paper", "ours", "verdict", "reason", "command"
    for v in reproduction.verdicts:
        c = v.claim
        command = "" if c.test is None else f"`reproduce {reproduction.paper.name} --claim {c.id}`"
        ours, verdict = verdict_text.ours(v), verdict_text.said(v)
        yield c.page, c.claim, c.said, ours, verdict, c.untestable or c.reason, command


def note(reproduction: Reproduction) -> str:
    """How the intervals and verdicts are corrected for the number of tests."""
    text = (
        f"{reproduction.family} tests at once: intervals hold together at {100 - 100 * ALPHA:g} % "
        "(Bonferroni); verdicts are Holm's at the same level, which decides a little more."
    )
    if len(reproduction.verdicts) < len(reproduction.paper.claims.claims):
        text += (
            " Of some claims alone only its first step is known, so that the page may decide more."
        )
    return text


def study_rows(reproduction: Reproduction) -> Iterator[tuple[str, ...]]:
    """Rows (experiment, variant, seeds, medians, loops lost), the heading first; the metrics are
    those that the studies name. A cell is empty where an experiment has no such metric. Of a study
    over levels the nominal one is shown."""
    studies = {n: e.study for n, e in reproduction.evidence.items() if e.study is not None}
    metrics = list(dict.fromkeys(m for study in studies.values() for m in study.spec.metrics))
    heads = (f"median {m.replace('_', ' ')}" for m in metrics)
    yield "experiment", "variant", "seeds", *heads, "loop lost [95 %]"
    for name, study in studies.items():
        known = {metric for runs in study.runs.values() for run in runs for metric in run or ()}
        for variant in study.runs:
            medians = (median(study.values(variant, m)) if m in known else "" for m in metrics)
            s = study.lost(variant)
            lost = f"{100 * s.value:.0f} % [{100 * s.low:.0f}, {100 * s.high:.0f}]"
            yield (
                name,
                study.experiment.label(variant),
                str(len(study.seeds)),
                *medians,
                lost if LOST in known else "",
            )


def region_rows(reproduction: Reproduction) -> Iterator[tuple[str, ...]]:
    """Rows (experiment, variant, grid, share of points inside, the least outcome and where), the
    heading first."""
    yield "experiment", "variant", "grid", "points inside", "least outcome"
    for name, evidence in reproduction.evidence.items():
        label = Experiment.load(reproduction.paper.experiments[name]).label
        for variant, region in evidence.regions.items():
            grid = f"{region.spec.x.count} × {region.spec.y.count}"
            share = f"{region.spec.outcome} < {region.spec.below:g}: {100 * region.share:.1f} %"
            yield name, label(variant), grid, share, _least(region)


def _least(region: Region) -> str:
    if region.least is None:
        return "–"
    x, y, outcome = region.least
    axes = (axis.key.rpartition(".")[2] for axis in (region.spec.x, region.spec.y))
    where = ", ".join(f"{axis} = {value:.6g}" for axis, value in zip(axes, (x, y), strict=True))
    return f"{outcome:.4g} at {where}"


def markdown(rows: Iterable[tuple[str, ...]]) -> str:
    """Rows, the heading first, as a Markdown table."""
    heading, *others = (tuple(cell.replace("|", "\\|") for cell in row) for row in rows)
    rule = ("---",) * len(heading)
    return "\n".join(f"| {' | '.join(row)} |" for row in (heading, rule, *others))


def update_readme(reproduction: Reproduction) -> Path:
    """Put the tables between the markers of the paper's README; raises `RecordingError`."""
    path = reproduction.paper.folder / "README.md"
    parts = {VERDICTS: verdict_rows, STUDIES: study_rows, REGIONS: region_rows}
    with writing(f"{path} cannot be updated", path.parent):
        text = path.read_text(encoding="utf-8")
        for part, rows in parts.items():
            table = list(rows(reproduction))
            if part == VERDICTS or len(table) > 1:
                above = f"{note(reproduction)}\n\n" if part == VERDICTS else ""
                text = _filled(path, text, part, above + markdown(table))
        with atomic_write(path) as partial:
            partial.write_text(text, encoding="utf-8")
    return path


def _filled(path: Path, text: str, part: str, table: str) -> str:
    begin, end = f"<!-- {part}: begin -->", f"<!-- {part}: end -->"
    before, found, rest = text.partition(begin)
    _, ended, after = rest.partition(end)
    if not found or not ended:
        raise RecordingError(f"{path} has no markers {begin} and {end}")
    return f"{before}{begin}\n{table}\n{end}{after}"


_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>
body {{ font: 15px/1.45 system-ui, sans-serif; max-width: 1100px; margin: 2em auto; }}
body {{ padding: 0 1em; }}
table {{ border-collapse: collapse; font-size: 13px; }}
td, th {{ border-top: 1px solid #ccc; padding: 4px 8px; text-align: left; vertical-align: top; }}
img {{ max-width: 100%; }} .note {{ color: #a33; }}
</style></head><body><h1>{title}</h1>{note}{tables}{figures}</body></html>
"""


def _table(rows: Iterable[tuple[str, ...]]) -> str:
    lines = []
    for i, row in enumerate(rows):
        tag = "th" if i == 0 else "td"
        lines.append("<tr>" + "".join(f"<{tag}>{html.escape(c)}</{tag}>" for c in row) + "</tr>")
    return "<p><table>" + "\n".join(lines) + "</table></p>"


def write_page(reproduction: Reproduction, output: Path) -> Path:
    """`index.html` in `output`: verdicts, studies and every picture, with relative links."""
    tables = f"<p>{html.escape(note(reproduction))}</p>" + _table(verdict_rows(reproduction))
    tables += _table(study_rows(reproduction))
    figures = []
    of_claims = write_pictures(reproduction.verdicts, output)
    for name, pictures in {"claims": of_claims, **reproduction.pictures}.items():
        sources = (html.escape(picture.relative_to(output).as_posix()) for picture in pictures)
        figures += [f"<h2>{html.escape(name)}</h2>"]
        figures += [f'<p><img src="{source}" alt="{source}"></p>' for source in sources]
    fast = (
        '<p class="note">Fast subset: few seeds, coarse grids. It shows that all of it works and '
        "decides nothing; its verdicts are not those of the paper.</p>"
    )
    path = output / "index.html"
    page = _PAGE.format(
        title=html.escape(reproduction.paper.claims.paper),
        note=fast if reproduction.fast else "",
        tables=tables,
        figures="\n".join(figures),
    )
    with writing(f"{path} cannot be written", output), atomic_write(path) as partial:
        partial.write_text(page, encoding="utf-8")
    return path
