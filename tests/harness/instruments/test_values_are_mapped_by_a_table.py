"""A table of values on a wire."""

import numpy as np
import pytest

from harness.errors import ExperimentError
from harness.instruments.imperfections import make_imperfection


def test_named_values_change_and_others_stay() -> None:
    block = make_imperfection("value_map", {"table": [[1, 3], [3, 1], [0, -2]]}).block(0.01)
    out = np.zeros(1)
    found = []
    for value in (1.0, 3.0, 0.0, 2.0, -0.5):
        block.step(block.parameters, block.state, np.array([value]), out)
        found.append(out[0])
    assert found == [3.0, 1.0, -2.0, 2.0, -0.5]


@pytest.mark.parametrize("table", [[[1, 2], [1, 3]], [[1]], 3, [[1, "a"]]])
def test_tables_that_mean_nothing(table: object) -> None:
    with pytest.raises(ExperimentError, match="'table'"):
        make_imperfection("value_map", {"table": table})
