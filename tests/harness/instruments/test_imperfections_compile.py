"""Every imperfection gives the same bits interpreted and compiled, also on odd readings."""

from typing import Any

import numpy as np
import pytest

from harness.instruments.imperfections import IMPERFECTIONS, make_imperfection
from tests.harness.instruments.kernels import compiled, run

EXAMPLES: list[tuple[str, dict[str, Any]]] = [
    ("noise", {"std": 1.0}),
    ("disturbance", {"signal": {"kind": "sine", "amplitude": 1.0, "frequency": 1.0}}),
    ("bias", {"value": 0.1}),
    ("gain", {"factor": 1.1}),
    ("quantisation", {"step": 0.3}),
    ("saturation", {"lower": -0.7, "upper": 0.9}),
    ("rate_limit", {"rate": 30.0, "falling_rate": 10.0}),
    ("delay_samples", {"samples": 3}),
    ("delay_samples", {"samples": 0}),
    ("dropout", {"probability": 0.4}),
    ("dropout", {"probability": 0.4, "mode": "zero"}),
    ("lag", {"time_constant": 0.07}),
    ("value_map", {"table": [[0.0, 2.0], [5e-324, -1.0], [1.0, 0.5]]}),
]
ODD = [0.0, -0.0, 5e-324, 1e308, -1e308, np.inf, -np.inf, np.nan]


def test_every_kind_is_tried() -> None:
    assert {kind for kind, _ in EXAMPLES} == set(IMPERFECTIONS)


@pytest.mark.filterwarnings("ignore:.*encountered:RuntimeWarning")
@pytest.mark.parametrize(("kind", "given"), EXAMPLES)
def test_same_bits(kind: str, given: dict[str, Any]) -> None:
    random = np.random.default_rng(8)
    readings = np.concatenate((random.standard_normal(200), ODD, random.standard_normal(20)))
    imperfection = make_imperfection(kind, given)
    block = imperfection.block(0.01, "N")
    added = random.random(len(readings)) if imperfection.source else None
    assert len(block.inputs) == (2 if imperfection.source else 1)
    interpreted = run(block, readings, added)
    native = run(block, readings, added, compiled(block.step))
    nan = np.isnan(interpreted)  # the sign of a NaN says nothing
    assert np.array_equal(nan, np.isnan(native))
    assert interpreted[~nan].tobytes() == native[~nan].tobytes()
