"""An order for one FMU carried out by the FMU Compliance Checker (fmuCheck)."""

from __future__ import annotations

from itertools import accumulate, repeat
from pathlib import Path

from tests.peers.order import answer, read_order
from tests.peers.program import rows_by

SUBSTEPS = 4000


def main() -> None:
    """fmuCheck adds up its steps, so the instants of the inputs are sums, too. It solves equations
    by forward Euler, which needs `SUBSTEPS` in a step. Errors alone are printed."""
    order = read_order()

    def arguments(path: str, given: Path, found: Path) -> list[str]:
        cs = order.interface == "co-simulation"
        kind, step = ("cs", order.step) if cs else ("me", order.step / SUBSTEPS)
        asked = ["-k", kind, "-h", repr(step), "-s", repr(order.steps * order.step)]
        asked += ["-n", str(0 if cs else order.steps), "-l", "2", "-o", str(found)]
        return [*asked, *(["-i", str(given)] if order.inputs else []), path]

    instants = accumulate(repeat(order.step, order.steps - 1), initial=0.0)
    answer(rows_by(arguments, order, list(zip(instants, order.rows(), strict=True))))


main()
