"""Running all experiments of a paper, judging its claims, and writing its page."""

from __future__ import annotations

import html
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from harness.errors import ExperimentError, HarnessError, RecordingError, UsageError, nearest
from harness.experiment.claims import ClaimsSpec, Evidence, Verdict, judge, load_claims
from harness.experiment.experiment import Experiment
from harness.experiment.parallel import Workers, given_or_one
from harness.experiment.report import write_report
from harness.experiment.study import LOST, median, run_study
from harness.experiment.sweep import run_sweep, write_sweep
from harness.results.atomic import atomic_write, writing
from harness.results.result import Result

CLAIMS_FILE = "claims.toml"
VERDICTS, STUDIES, REGIONS = "verdicts", "studies", "regions"
"""Names of the parts of a paper's README that are filled from runs, between markers."""

Report = Callable[[float, str], None]
"""Called with the share that is done of what is being run, and its name."""


@dataclass(frozen=True)
class Paper:
    """A folder of experiments with its claims."""

    name: str
    folder: Path
    experiments: Mapping[str, Path]
    claims: ClaimsSpec


@dataclass(frozen=True)
class Reproduction:
    """A paper with its verdicts, and the evidence and pictures of each experiment."""

    paper: Paper
    verdicts: tuple[Verdict, ...]
    evidence: Mapping[str, Evidence]
    pictures: Mapping[str, tuple[Path, ...]]
    fast: bool


def load_paper(name: str, experiments: Mapping[str, Path]) -> Paper:
    """The paper `name` among `experiments` ("paper/figure" to path); raises `UsageError`."""
    papers = {key.partition("/")[0] for key in experiments}
    if name not in papers:
        raise UsageError(f"no paper {name!r}; {nearest(name, papers)}")
    own = {k.partition("/")[2]: p for k, p in experiments.items() if k.startswith(f"{name}/")}
    folder = next(iter(own.values())).parent
    if not (folder / CLAIMS_FILE).is_file():
        raise ExperimentError(f"paper {name} has no {CLAIMS_FILE} in {folder}")
    return Paper(name, folder, own, load_claims(folder / CLAIMS_FILE))


def reproduce(
    paper: Paper,
    output: Path,
    *,
    fast: bool = False,
    workers: Workers | None = None,
    report: Report | None = None,
) -> Reproduction:
    """Run every experiment of `paper` and judge its claims; pictures and rows go to `output`.
    Studies and sweeps are spread over `workers` (None: one process of its own).

    `fast` takes the subset that the experiments declare: enough to see that all of it works, not
    to decide.
    """
    _check_claims(paper)
    evidence: dict[str, Evidence] = {}
    pictures: dict[str, tuple[Path, ...]] = {}
    with given_or_one(workers) as crew:
        for name, path in paper.experiments.items():
            experiment = Experiment.load(path)
            experiment = experiment.fast() if fast else experiment
            evidence[name], pictures[name] = _run(experiment, output / name, crew, report)
    verdicts = tuple(judge(claim, evidence.__getitem__) for claim in paper.claims.claims)
    return Reproduction(paper, verdicts, evidence, pictures, fast)


def _check_claims(paper: Paper) -> None:
    for claim in paper.claims.claims:
        for test in (claim.test, claim.given):
            if test is not None and test.experiment not in paper.experiments:
                raise UsageError(
                    f"claim {claim.id} of {paper.name}: no experiment {test.experiment!r}; "
                    f"{nearest(test.experiment, paper.experiments)}"
                )


def _run(
    experiment: Experiment, folder: Path, workers: Workers, report: Report | None
) -> tuple[Evidence, tuple[Path, ...]]:
    def progress(what: str) -> Callable[[float], None]:
        return lambda share: None if report is None else report(share, f"{experiment.name}{what}")

    results: dict[str, Result] = {}
    for variant in experiment.variants:
        try:
            label = f": {experiment.label(variant)}"
            results[variant] = experiment.run(variant, folder / variant, progress=progress(label))
        except HarnessError as fault:
            if fault.result is None:
                raise
            results[variant] = fault.result
    written = write_report(experiment, results, folder)
    study, regions = None, {}
    if experiment.spec.study is not None:
        study = run_study(experiment, workers=workers, progress=progress(": study"))
        study.write(folder)
    if experiment.spec.sweep is not None:
        regions = run_sweep(experiment, workers=workers, progress=progress(": sweep"))
        written += write_sweep(experiment, regions, folder)
    metrics = {variant: dict(result.metrics) for variant, result in results.items()}
    pictures = tuple(path for path in written if path.suffix == ".png")
    return Evidence(metrics, study, regions), pictures


def verdict_rows(reproduction: Reproduction) -> Iterator[tuple[str, ...]]:
    """Rows (page, claim, paper, ours, verdict, reason, command), the heading first."""
    yield "page", "claim", "paper", "ours", "verdict", "reason", "command"
    for v in reproduction.verdicts:
        c = v.claim
        ours = "–" if v.ours is None else f"{v.ours} {c.unit}".strip()
        if v.given is not None and c.given is not None:
            ours += f"; given {c.given.experiment}/{c.given.variant}: {v.given} {c.unit}".rstrip()
        reason = c.untestable or c.reason
        test = c.test
        command = "" if test is None else f"`run {reproduction.paper.name}/{test.experiment}`"
        yield c.page, c.claim, c.said, ours, v.verdict, reason, command


def study_rows(reproduction: Reproduction) -> Iterator[tuple[str, ...]]:
    """Rows (experiment, variant, seeds, medians, loops lost), the heading first; the metrics are
    those that the studies name. A cell is empty where an experiment has no such metric."""
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
    """Rows (experiment, variant, grid, share of points inside), the heading first."""
    yield "experiment", "variant", "grid", "points inside"
    for name, evidence in reproduction.evidence.items():
        label = Experiment.load(reproduction.paper.experiments[name]).label
        for variant, region in evidence.regions.items():
            grid = f"{region.spec.x.count} × {region.spec.y.count}"
            yield name, label(variant), grid, f"{100 * region.share:.1f} %"


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
                text = _filled(path, text, part, markdown(table))
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
    tables = _table(verdict_rows(reproduction)) + _table(study_rows(reproduction))
    figures = []
    for name, pictures in reproduction.pictures.items():
        sources = (html.escape(picture.relative_to(output).as_posix()) for picture in pictures)
        figures += [f"<h2>{html.escape(name)}</h2>"]
        figures += [f'<p><img src="{source}" alt="{source}"></p>' for source in sources]
    note = (
        '<p class="note">Fast subset: few seeds, coarse grids. It shows that all of it works and '
        "decides nothing; its verdicts are not those of the paper.</p>"
    )
    path = output / "index.html"
    page = _PAGE.format(
        title=html.escape(reproduction.paper.claims.paper),
        note=note if reproduction.fast else "",
        tables=tables,
        figures="\n".join(figures),
    )
    with writing(f"{path} cannot be written", output), atomic_write(path) as partial:
        partial.write_text(page, encoding="utf-8")
    return path
