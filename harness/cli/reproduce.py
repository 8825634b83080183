"""`fmu-harness reproduce`: run a paper, judge its claims, write its page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from harness import registry
from harness.cli.tables import show_table
from harness.cli.terminal import bar, note, say, table
from harness.errors import UsageError

FAST = (
    "the fast subset shows that all of it works and decides nothing: the verdicts above are of a "
    "few seeds and coarse grids, and not those of the paper's page"
)


def reproduce_command(
    papers: Annotated[
        list[str] | None, typer.Argument(help="Papers; all when none is named")
    ] = None,
    output: Annotated[Path | None, typer.Option(help="Folder of the pages")] = None,
    fast: Annotated[
        bool, typer.Option(help="Few seeds and coarse grids, which decide nothing")
    ] = False,
    claim: Annotated[
        list[str] | None, typer.Option(help="Only this claim of one paper, by id; repeatable")
    ] = None,
    update: Annotated[bool, typer.Option(help="Write the READMEs' verdicts")] = False,
    jobs: Annotated[int, typer.Option(help="Processes; 0: one a core")] = 0,
) -> None:
    """Run all experiments of papers and judge their claims."""
    from rich import box

    from harness.experiment import pages, reproduce
    from harness.experiment.parallel import Workers

    known = registry.experiments()
    names = papers or sorted({name.partition("/")[0] for name in known})
    loaded = [reproduce.load_paper(name, known) for name in names]
    root = output or registry.run_folder("reproduce")
    if update and fast:
        raise UsageError(
            "the fast subset decides nothing, so --update does not go with --fast; leave one out"
        )
    if claim and (update or len(loaded) != 1):
        raise UsageError("--claim goes with one paper and without --update: a page has all claims")
    with Workers(jobs, isolated=True) as workers:
        for paper in loaded:
            with bar(paper.name) as moved:
                folder = root / paper.name
                done = reproduce.reproduce(
                    paper, folder, fast=fast, only=claim or (), workers=workers, report=moved
                )
                moved(1.0)
            headings, *rows = (row[:5] for row in pages.verdict_rows(done))
            title = paper.claims.paper
            show_table(table(headings, rows, title=title, box=box.HEAVY_HEAD))
            say(pages.note(done))
            written = [pages.write_page(done, folder)]
            if update:
                written.append(pages.update_readme(done))
            for path in written:
                say(f"written: {path}")
    if fast:
        note(FAST)
