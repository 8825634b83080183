"""The doctor moves inputs about their start values, and never out of what the FMU declares."""

from __future__ import annotations

from dataclasses import replace

import pytest

from harness.fmi.description.model_description import Details, Variable
from harness.inspection.excitation import moving_inputs
from tests.harness.inspection.descriptions import described

PLAIN = Variable("u", 1, "Float64", "input", "continuous", "exact", "2", None, "", None, None, None)
OPTION = Details(items=((3, "slow"), (7, "fast")))


def values(variable: Variable) -> list[tuple[float, ...]]:
    """What the input is set to in 40 steps of 0.5 s from t = 1 s."""
    inputs = moving_inputs(described(variable), 1.0, 0.5)
    tracks = [*inputs.continuous, *inputs.held]
    return [tuple(tracks[0].after(1.0 + 0.5 * k)) for k in range(40)] if tracks else []


def test_a_real_input_waves_about_its_start_value() -> None:
    found = [one for (one,) in values(PLAIN)]
    assert len(set(found)) == 40
    assert max(abs(one - 2.0) for one in found) == pytest.approx(0.1, rel=0.01)


def test_it_is_constant_within_a_step() -> None:
    (track,) = moving_inputs(described(PLAIN), 1.0, 0.5).continuous
    assert track.after(1.5) == track.after(1.75) == track.after(1.999) != track.after(2.0)


def test_limits_hold() -> None:
    found = values(replace(PLAIN, minimum=2.0, maximum=2.05))
    assert min(found) == (2.0,) and max(found) == (2.05,)


def test_each_element_of_an_array_moves_by_itself() -> None:
    rows = values(replace(PLAIN, size=2, shape=(2,), dimensions=(2,), start="0 100"))
    assert {len(row) for row in rows} == {2}
    assert all(abs(a) <= 0.05 and abs(b - 100) <= 5.0 for a, b in rows)
    assert all(20 * a != (b - 100) / 5 for a, b in rows)


@pytest.mark.parametrize(
    ("change", "legal"),
    [
        ({"type": "Boolean", "start": "true"}, {0, 1}),
        ({"type": "Enumeration", "start": "7", "details": OPTION}, {3, 7}),
        ({"type": "Int32", "start": "4", "minimum": 3.0, "maximum": 100.0}, {3, 4, 5, 6}),
    ],
)
def test_what_is_not_real_takes_legal_values_in_turn(
    change: dict[str, object], legal: set[int]
) -> None:
    found = values(replace(PLAIN, **change))  # type: ignore[arg-type]
    assert {one for (one,) in found} == legal
    assert found[0] == (float({"true": "1"}.get(str(change["start"]), str(change["start"]))),)


@pytest.mark.parametrize(
    "change",
    [
        {"type": "Int32"},
        {"type": "String", "start": "a"},
        {"type": "Binary", "start": "ff"},
        {"type": "Clock", "start": None},
        {"details": Details(clocks=("tick",))},
    ],
)
def test_what_might_be_illegal_stays(change: dict[str, object]) -> None:
    assert values(replace(PLAIN, **change)) == []  # type: ignore[arg-type]
