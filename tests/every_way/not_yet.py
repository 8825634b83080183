"""What a way cannot do yet: the one place that says which cases are expected to fail, and why.

A row that holds no longer makes its tests fail ("XPASS"), and is then to be taken out.
"""

from dataclasses import dataclass

BENCH = frozenset({"bench", "worker", "wires"})


@dataclass(frozen=True)
class NotYet:
    """Cases that need `need` fail in these `ways`."""

    ways: frozenset[str]
    need: str
    reason: str


NOT_YET = (
    NotYet(BENCH, "triggers", "a wire acts after the row of its instant, a track before"),
    NotYet(frozenset({"doctor"}), "texts", "the doctor watches numbers"),
    NotYet(frozenset({"doctor"}), "64 bits", "the doctor watches float64"),
    NotYet(frozenset({"doctor"}), "resized", "the doctor sizes arrays by the file"),
    NotYet(frozenset({"doctor"}), "triggers", "the doctor triggers no clocks"),
)


def reason(way: str, needs: frozenset[str]) -> str | None:
    """Why a case cannot be run that way, or None."""
    found = [one.reason for one in NOT_YET if way in one.ways and one.need in needs]
    return "; ".join(found) or None
