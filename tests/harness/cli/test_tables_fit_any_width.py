"""At 60, 80 and 200 columns every number and name of a table is whole, on lines that fit."""

import io
from collections.abc import Iterable

import pytest
from rich import box
from rich.console import Console
from rich.table import Table

from harness.cli.tables import fitted
from harness.cli.terminal import properties, table

NAMES = ("PID", "fuzzy PID, tuned by a robust extended Kalman filter", "plant.a_very_long_name")
NUMBERS = [[f"{-1.2345 * 10.0 ** (row - column):.5g}" for column in range(9)] for row in range(3)]


def lines(tables: Iterable[Table], width: int) -> list[str]:
    out = io.StringIO()
    console = Console(file=out, width=width, highlight=False)
    for one in tables:
        console.print(one, crop=False, overflow="ignore")
    return out.getvalue().splitlines()


@pytest.mark.parametrize("width", [60, 80, 200])
@pytest.mark.parametrize("style", [None, box.SIMPLE_HEAD, box.HEAVY_HEAD])
def test_numbers_are_whole(width: int, style: box.Box | None) -> None:
    headings = ("variant", *(f"figure {k}" for k in range(9)))
    rows = [(name, *numbers) for name, numbers in zip(NAMES, NUMBERS, strict=True)]
    printed = lines(fitted(table(headings, rows, right=headings[1:], box=style), width), width)
    words = [word for line in printed for word in line.replace("│", " ").split()]
    assert all(number in words for numbers in NUMBERS for number in numbers)
    assert "plant.a_very_long_name" in words and "…" not in "".join(printed)
    assert max(map(len, printed)) <= width
    parts = len([line for line in printed if "variant" in line])
    assert parts == (1 if width == 200 else parts) and parts >= (1 if width == 200 else 2)


@pytest.mark.parametrize("width", [60, 80, 200])
def test_texts_wrap_between_words(width: int) -> None:
    text = "one two three four five six seven eight nine ten " * 4
    printed = lines(fitted(properties("title", [("a_name", text), ("b", "short")]), width), width)
    assert max(map(len, printed)) <= width and len(printed) < 3 + len(text) // (width - 16)
    assert "".join(printed).split() == ["a_name", *text.split(), "b", "short"]


def test_what_cannot_be_narrower_is_not_cut() -> None:
    name = "x" * 90
    printed = lines(fitted(table(("name", "value"), [(name, "1.25")], right=["value"]), 60), 60)
    assert any(name in line for line in printed) and "1.25" in "".join(printed)
