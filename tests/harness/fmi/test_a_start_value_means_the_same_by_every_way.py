"""A start value arrives in the FMU as the same number, and fails with the same sentence, from a
Bench, a file, `simulate`, a flag of the command line and the parameters of a package."""

from pathlib import Path

import pytest

from harness.errors import HarnessError
from tests.harness.fmi.ways_of_start_values import WAYS, Starts, Way
from tests.harness.simulation.fmus import needs_compiler

pytestmark = [needs_compiler, pytest.mark.filterwarnings("ignore:.*states no")]


@pytest.fixture(params=WAYS, ids=lambda way: way.__name__)
def way(request: pytest.FixtureRequest) -> Way:
    return request.param


@pytest.mark.parametrize(
    ("starts", "output", "expected"),
    [
        ({"h": (3, "ft")}, "h", 0.9144),
        ({"h": "2"}, "h", 2.0),
        ({"w[2]": 7.0}, "doubled[2]", 14.0),
        ({"w[2]": 7.0}, "doubled[3]", 6.0),
        ({"n": 2, "w": [5.0, 6.5]}, "doubled[2]", 13.0),
        ({"w[5]": 9.0, "n": 5}, "doubled[5]", 18.0),
        ({"Enumeration_in": "high"}, "Enumeration_out", 7.0),
        ({"Enumeration_in": 7}, "Enumeration_out", 7.0),
        ({"Boolean_in": "true"}, "Boolean_out", 1.0),
        ({"Int8_in": "-5"}, "Int8_out", -5.0),
    ],
)
def test_it_arrives(
    way: Way, starts: Starts, output: str, expected: float,
    tmp_path: Path,
) -> None:  # fmt: skip
    assert way(starts, output, tmp_path) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("starts", "sentence"),
    [
        ({"h": "high"}, "'h' must be a number (Float64), not 'high'"),
        ({"Enumeration_in": 3}, "'Enumeration_in' must be one of 1 'low', 7 'high', not 3"),
        ({"Int8_in": 300}, "'Int8_in' must be between -128 and 127 (Int8), not 300"),
        ({"Boolean_in": "maybe"}, "'Boolean_in' must be true or false, not 'maybe'"),
        ({"counter": 1}, "'counter' cannot be set, for the FMU calculates it (output); "),
        ({"w[4]": 1.0}, "'w[4]' is for no element of 'w', whose sizes are 3"),
        ({"w": [1.0, 2.0]}, "'w' must have 3 element(s), not 2"),
        ({"n": 2, "w": [1.0, 2.0, 3.0]}, "'w' must have 2 element(s), not 3"),
    ],
)
def test_it_fails_with_the_same_sentence(
    way: Way, starts: Starts, sentence: str, tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    with pytest.raises(HarnessError) as caught:
        way(starts, "h", tmp_path)
    told = " ".join((str(caught.value) + capsys.readouterr().err).split())
    assert f"component test: start value of {sentence}" in told
