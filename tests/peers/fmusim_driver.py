"""An order for one FMU carried out by fmusim, the program of the Reference FMUs until July 2026."""

from __future__ import annotations

from pathlib import Path

from tests.peers.order import TOLERANCE, answer, read_order
from tests.peers.program import rows_by


def main() -> None:
    """The right-hand side that fmusim's CVODE calls sets no inputs, and its steps go past the
    instants at which they change: it solves equations rightly under constant inputs alone."""
    order = read_order()

    def arguments(path: str, given: Path, found: Path) -> list[str]:
        asked = [
            "--interface-type", "cs" if order.interface == "co-simulation" else "me",
            "--stop-time", repr(order.steps * order.step), "--output-interval", repr(order.step),
            "--output-file", str(found),
        ]  # fmt: skip
        if order.interface == "model-exchange":
            asked += ["--solver", "cvode", "--tolerance", repr(TOLERANCE)]
        if order.inputs:
            asked += ["--input-file", str(given)]
        for port in order.outputs:
            asked += ["--output-variable", port.partition(".")[2]]
        return [*asked, path]

    table = [(k * order.step, row) for k, row in enumerate(order.rows())]
    answer(rows_by(arguments, order, table))


main()
