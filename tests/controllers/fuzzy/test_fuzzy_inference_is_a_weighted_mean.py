"""Properties of the inference: partitions, bounds, table entries, general systems, silence."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.core.errors import ControllerError
from controllers.fuzzy.inference import FuzzySystem, Membership, Rule, infer, triangular_partition
from controllers.fuzzy.membership import TRIANGULAR, membership
from controllers.papers.ahn2009.fuzzy_pid import AXES, LABELS, TABLE_2, FuzzyPID

PID_5 = FuzzyPID(kp=(0, 1), ki=(0, 1), kd=(0, 1), error_range=1.0, error_rate_range=1.0)
unit = st.floats(0.0, 1.0)


@given(x=unit, count=st.integers(2, 9))
def test_initial_triangles_sum_to_one(x: float, count: int) -> None:
    degrees = [membership(TRIANGULAR, x, np.array(f.parameters))
               for f in triangular_partition(count)]  # fmt: skip
    assert sum(degrees) == pytest.approx(1.0, abs=1e-12)
    assert sum(d > 1e-12 for d in degrees) <= 2


@settings(max_examples=200, deadline=None)
@given(
    x=st.tuples(unit, unit),
    weights=st.lists(st.floats(-1e3, 1e3), min_size=5, max_size=5),
    implication=st.sampled_from(["min", "product"]),
    aggregation=st.sampled_from(["sum", "max"]),
)
def test_output_lies_between_the_weights(x, weights, implication, aggregation) -> None:
    base = PID_5.system("p")
    system = FuzzySystem(base.inputs, (tuple(weights),), base.rules, implication, aggregation)
    assert min(weights) <= system.evaluate(*x)[0] <= max(weights)


def test_at_the_grid_points_table_2_is_read() -> None:
    for place, axis in enumerate(AXES):
        for i in range(5):
            for j in range(5):
                expected = LABELS.index(TABLE_2[i][j][place]) / 4
                assert PID_5.system(axis).evaluate(i / 4, j / 4)[0] == expected


def test_min_sum_by_hand() -> None:
    # |e| = 0.30: VS 0.8, S 0.2; |de| = 0.10: Z 0.6, VS 0.4. Heights of Table 2 (U_p):
    # (VS,Z) VS 0.6, (VS,VS) VS 0.4, (S,Z) S 0.2, (S,VS) S 0.2, so (1.0·0.25 + 0.4·0.5)/1.4.
    assert PID_5.system("p").evaluate(0.30, 0.10)[0] == pytest.approx(0.45 / 1.4, rel=1e-12)


def test_three_inputs_two_outputs_and_rules_that_leave_out() -> None:
    bell = Membership("gaussian", (0.0, 1.0))
    system = FuzzySystem(
        inputs=((bell,), (bell, Membership("sigmoidal", (0.0, 2.0))), (bell,)),
        weights=((1.0, 5.0), (10.0, 20.0)),
        rules=(Rule((0, -1, -1), (0, -1)), Rule((-1, 1, -1), (1, 0)), Rule((0, 0, 0), (-1, 1))),
        implication="product",
    )
    g, h = np.exp(-0.25), 1 / (1 + np.exp(-1.0))
    g3 = np.exp(-0.25 * 3)
    expected = [(g * 1 + h * 5) / (g + h), (h * 10 + g3 * 20) / (h + g3)]
    np.testing.assert_allclose(system.evaluate(0.5, 0.5, 0.5), expected, rtol=1e-12)


def test_where_nothing_fires_the_output_keeps_its_value_and_says_so() -> None:
    narrow = Membership("triangular", (0.0, 0.1, 0.1))
    system = FuzzySystem(((narrow,),), ((0.7,),), (Rule((0,), (0,)),))
    out = np.array([0.123])
    work = (np.zeros(1), np.zeros(1), np.zeros(1))
    assert infer(system.structure(), system.theta(), np.array([0.5]), *work, out) == 1
    assert out[0] == 0.123
    assert np.isnan(system.evaluate(0.5)[0])


def test_faults_are_named() -> None:
    with pytest.raises(ControllerError, match="b_plus: expected a width greater than 0"):
        Membership("triangular", (0.0, 1.0, 0.0))
    with pytest.raises(ControllerError, match=r"rule 1: antecedents: .* from -1 to 1"):
        FuzzySystem((triangular_partition(2),), ((1.0,),), (Rule((2,), (0,)),))
