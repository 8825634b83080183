"""All benchmarks in one go, all sides in turn.

    python -m benchmarks [CASE …] [--rounds 7] [--peers NAME …] [--page docs/how-fast.md]
        [--json FILE] [--markdown FILE] [--plot FOLDER]

Cases are those of `benchmarks.cases.CASES`, all where none is named. `python -m benchmarks.peers
install` makes the environments of the peers first; a peer without one is a line that says so.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

from benchmarks import page
from benchmarks.cases import CASES
from benchmarks.frame import Setting, measure
from benchmarks.measuring import write_json
from benchmarks.peers.environments import PEERS


def main() -> None:
    """Measure, print, and write what is asked for."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("cases", nargs="*", metavar="CASE", help=", ".join(CASES))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--peers", nargs="*", default=list(PEERS), metavar="NAME")
    parser.add_argument("--page", type=Path, help="a page to write the tables into")
    parser.add_argument("--json", type=Path, help="write all numbers there")
    parser.add_argument("--markdown", type=Path, help="write the tables there")
    parser.add_argument("--plot", type=Path, metavar="FOLDER", help="write the pictures there")
    given = parser.parse_args()
    for kind, asked, known in (("case", given.cases, CASES), ("peer", given.peers, PEERS)):
        if unknown := set(asked) - set(known):
            parser.error(f"no {kind} is called {', '.join(unknown)}; there are {', '.join(known)}")
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        setting = Setting(folder, tuple(given.peers), stack)
        comparisons = [
            comparison for name in given.cases or CASES for comparison in CASES[name](setting)
        ]
        found = measure(comparisons, given.rounds, lambda line: print(line, file=sys.stderr))
    tables = page.text(found, given.rounds)
    print(tables)
    if given.page:
        page.write_page(given.page, found, given.rounds)
    if given.plot:
        page.write_pictures(given.plot, found)
    if given.markdown:
        given.markdown.write_text(tables, encoding="utf-8")
    if given.json:
        write_json(given.json, {"comparisons": page.plain(found)})


if __name__ == "__main__":
    main()
