"""In a round every side runs once, the first round does not count, and what refuses or fails is a
line that says why; aims are judged by the medians of figures within a round."""

from pathlib import Path

import pytest

from benchmarks.frame import Aim, Comparison, Found, RefusedError, Side, measure, middle
from benchmarks.page import BEGIN, END, judged, table, write_page


def comparison(calls: list[str]) -> Comparison:
    """Two sides that count their calls, one that refuses, one that fails, one of a single round."""

    def counted(name: str, factor: float) -> Side:
        def run() -> float:
            calls.append(name)
            return factor * len(calls)

        return Side(run)

    def refuses() -> float:
        raise RefusedError("no wheel")

    sides = {
        "a": counted("a", 1.0), "b": counted("b", 2.0), "gone": Side(refuses),
        "wrong": Side(lambda: 1.0 / 0.0), "once": Side(lambda: 7.0, rounds=1),
    }  # fmt: skip
    aims = (
        Aim("b over a", "b", 3.0, "far", against="a"),
        Aim("b less a", "b", 0.5, "far", against="a", above=True),
        Aim("gone", "gone", 1.0, "far"),
    )
    return Comparison("name", "Title", "s", sides, "a", aims)


def found(calls: list[str]) -> Found:
    return measure([comparison(calls)], 3, lambda line: None)[0]


def test_sides_take_turns_and_the_first_round_is_thrown_away() -> None:
    calls: list[str] = []
    one = found(calls)
    assert "".join(calls) == "abababab"
    assert one.rounds["a"] == [3.0, 5.0, 7.0] and one.rounds["b"] == [8.0, 12.0, 16.0]
    assert one.ratios("b", "a") == [8 / 3, 12 / 5, 16 / 7]
    assert one.rounds["once"] == [7.0, None, None] and one.ratios("once", "a") == [7 / 3]
    assert one.refused == {
        "gone": "no wheel", "wrong": "ZeroDivisionError: float division by zero"
    }  # fmt: skip


def test_aims_are_met_or_say_what_is_in_the_way() -> None:
    one = found([])
    ratio, difference, gone = (judged(one, aim) for aim in one.comparison.aims)
    assert ratio == ("b over a", "at most 3 times a", "2.4 (2.29 to 2.67)", "met")
    assert difference == ("b less a", "at most 0.5 s above a", "7 (5 to 9) s", "far")
    assert gone[2:] == ("– s", "no wheel")


def test_the_table_has_a_line_for_every_side() -> None:
    lines = table(found([])).splitlines()
    assert lines[0] == "| side | s | times a |"
    assert lines[2] == "| a | 5 (3 to 7) | 1 (1 to 1) |"
    assert lines[4] == "| gone | no: no wheel |  |"
    assert lines[6] == "| once | 7 | 2.33 |"


def test_numbers_have_three_digits_and_no_exponent_where_they_are_short() -> None:
    assert middle([123456.0]) == "123456" and middle([0.001234]) == "0.00123"
    assert middle([]) == "–"


def test_a_page_keeps_what_is_around_the_marks(tmp_path: Path) -> None:
    page = tmp_path / "fast.md"
    page.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n")
    write_page(page, [found([])], 3)
    text = page.read_text()
    assert text.startswith("before\n") and text.endswith(f"{END}\nafter\n") and "old" not in text
    assert "![Title: s by side](fast/name.png)" in text
    assert (tmp_path / "fast" / "name.png").read_bytes().startswith(b"\x89PNG")
    page.write_text("nothing")
    with pytest.raises(SystemExit, match="lacks the line"):
        write_page(page, [], 3)
