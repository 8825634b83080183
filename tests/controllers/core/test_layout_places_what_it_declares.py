"""A layout gives every part the place that its shapes say, for constants and for tables alike."""

import numpy as np
import pytest

from controllers.core.errors import ControllerError
from controllers.core.layout import Layout, part, row_of

LAYOUT = Layout.of(seen=(), gamma=3, theta=(2, "n"), P=("n", "n"), work="work")


def test_constants_are_the_places_as_far_as_sizes_are_numbers() -> None:
    assert LAYOUT.places() == (0, 1, 4)
    assert LAYOUT.place("theta") == 4
    with pytest.raises(ControllerError, match="theta: expected the size n, received none"):
        LAYOUT.place("P")


def test_the_table_begins_where_it_is_told_and_ends_with_the_end() -> None:
    table = LAYOUT.table(10, n=4, work=2)
    np.testing.assert_array_equal(table, [10, 11, 14, 22, 38, 40])
    assert len(table) == LAYOUT.entries


def test_parts_and_rows_are_views_of_what_was_filled_in() -> None:
    theta = np.arange(8.0).reshape(2, 4)
    x = LAYOUT.fill({"theta": theta, "gamma": (7, 8, 9)}, n=4, work=2)
    table = LAYOUT.table(n=4, work=2)
    assert len(x) == table[-1]
    np.testing.assert_array_equal(part(table, x, LAYOUT.number("gamma")), [7, 8, 9])
    second = row_of(part(table, x, LAYOUT.number("theta")), 1, 2)
    np.testing.assert_array_equal(second, theta[1])
    second[0] = -1.0
    assert x[LAYOUT.place("theta") + 4] == -1.0
    assert not part(table, x, LAYOUT.number("P")).any()


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"gamma": (1.0, 2.0)}, r"gamma: expected shape \(3,\), received \(2,\)"),
        ({"Gamma": 1.0}, "one of seen, gamma, theta, P, work, received 'Gamma'"),
    ],
)
def test_what_does_not_fit_is_refused(values: dict[str, object], message: str) -> None:
    with pytest.raises(ControllerError, match=message):
        LAYOUT.fill(values, n=4, work=2)
